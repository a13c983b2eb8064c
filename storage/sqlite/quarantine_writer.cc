#include "storage/sqlite/quarantine_writer.h"

#include "storage/tables/set_aside.h"

namespace uplink::storage::sqlite {

absl::Status WriteQuarantineRow(TableWriters& rows, const CommitRecord& record,
                                const model::Rejection& rejection, EntryNumber entry) {
  absl::Status status;
  for (const QuarantineDetail detail :
       {QuarantineDetail::kAll, QuarantineDetail::kWithoutPayload, QuarantineDetail::kBare}) {
    if (detail == QuarantineDetail::kWithoutPayload && record.payload.empty()) continue;
    status = rows.Write<kQuarantineTable>({&record, rejection, detail, entry});
    if (!absl::IsInvalidArgument(status)) return status;
  }
  return status;
}

}  // namespace uplink::storage::sqlite
