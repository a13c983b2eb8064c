#include "storage/postgres/rejection_row.h"

#include <string>

namespace uplink::storage::postgres {

model::RejectReason ReasonOf(std::int64_t number) {
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    if (static_cast<std::int64_t>(reason) == number) return reason;
  }
  return model::RejectReason::kStoreRefused;
}

model::Rejection ReadRejection(const Result& rows, int row, int column) {
  return {ReasonOf(rows.Int(row, column)), std::string(rows.Bytes(row, column + 1)),
          std::string(rows.Bytes(row, column + 2))};
}

}  // namespace uplink::storage::postgres
