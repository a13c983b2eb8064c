#include "storage/sqlite/connections.h"

#include <string_view>
#include <utility>

#include "storage/sqlite/migrations.h"
#include "storage/sqlite/schema.h"

namespace uplink::storage::sqlite {
namespace {

absl::Status SetUp(Database& database, const StoreOptions& options) {
  const IfOlder if_older = options.migrate ? IfOlder::kMigrate : IfOlder::kRefuse;
  absl::Status status = RefuseDamage(database, options.on_damage_check);
  if (status.ok()) status = CheckFile(database, Migrations());
  if (status.ok()) status = ConfigureWriter(database);
  if (status.ok()) status = Migrate(database, Migrations(), if_older);
  if (status.ok() && options.pages_max) {
    status = database.Execute("PRAGMA max_page_count = " + std::to_string(*options.pages_max));
  }
  return status;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> OpenWriter(const std::string& path,
                                                     const StoreOptions& options) {
  if (absl::Status emptied = RefuseEmptied(path); !emptied.ok()) return emptied;
  auto database = Database::Open(path, Access::kWrite, options.busy_timeout);
  if (!database.ok()) return database;
  if (absl::Status set = SetUp(**database, options); !set.ok()) {
    return StatusOfFailedStart(**database, set);
  }
  return database;
}

absl::Status StatusOfFailedStart(Database& database, const absl::Status& failed) {
  if (!absl::IsDataLoss(failed)) return failed;
  Damage(database.path()).Note("a start found it damaged");
  std::string text = "store " + database.path() + " is damaged: ";
  text += std::string_view(failed.message().data(), failed.message().size());
  return absl::FailedPreconditionError(text);
}

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

absl::StatusOr<SideConnection> OpenSideConnection(const std::string& path, DamagePtr damage) {
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
  return SideConnection{*std::move(joined), *std::move(database)};
}

}  // namespace uplink::storage::sqlite
