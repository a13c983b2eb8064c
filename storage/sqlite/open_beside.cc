#include "storage/sqlite/open_beside.h"

#include <utility>

#include "storage/sqlite/migrations.h"
#include "storage/sqlite/schema.h"

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<Database>> OpenToRead(const std::string& path,
                                                     milliseconds busy_timeout, DamagePtr damage) {
  auto database = Database::Open(path, Access::kRead, busy_timeout);
  if (!database.ok()) return database.status();
  absl::Status status = CheckFile(**database, Migrations());
  if (status.ok()) status = Migrate(**database, Migrations(), IfOlder::kRefuse);
  if (!status.ok()) return status;
  (*database)->ReportDamageTo(std::move(damage));
  return database;
}

absl::StatusOr<Beside> OpenBeside(const std::string& path, DamagePtr damage) {
  auto joined = FileLock::Join(path);
  if (!joined.ok()) return joined.status();
  // A look that makes no file comes first.
  auto there = Database::Open(path, Access::kRead, kBusyTimeout);
  if (!there.ok()) return there.status();
  auto database = Database::Open(path, Access::kWrite, kBusyTimeout);
  if (!database.ok()) return database.status();
  absl::Status status = CheckFile(**database, Migrations());
  if (status.ok()) status = Migrate(**database, Migrations(), IfOlder::kRefuse);
  if (status.ok()) status = ConfigureWriter(**database);
  if (!status.ok()) return status;
  (*database)->ReportDamageTo(std::move(damage));
  return Beside{*std::move(joined), *std::move(database)};
}

}  // namespace uplink::storage::sqlite
