#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {

absl::Status Tables::Prepare(Database& database) {
  absl::Status status = deciding.Prepare(database);
  if (status.ok()) status = set_aside.Prepare(database);
  if (status.ok()) status = rows.Prepare(database);
  for (const PresentKind kind : {PresentKind::kFault, PresentKind::kShape, PresentKind::kObject}) {
    if (status.ok()) status = present_rows(kind).Prepare(database, kind);
  }
  if (status.ok()) status = open_runs.Prepare(database);
  if (status.ok()) status = quarantine_bound.Prepare(database);
  if (status.ok()) status = retention.Prepare(database);
  if (status.ok()) status = live.Prepare(database);
  if (status.ok()) status = changes.Prepare(database);
  if (status.ok()) status = topics.Prepare(database);
  return status;
}

}  // namespace uplink::storage::sqlite
