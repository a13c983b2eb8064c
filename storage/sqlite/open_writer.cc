#include "storage/sqlite/open_writer.h"

#include <string_view>

#include "storage/sqlite/damage.h"
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
    return StartFailed(**database, set);
  }
  return database;
}

absl::Status StartFailed(Database& database, const absl::Status& failed) {
  if (!absl::IsDataLoss(failed)) return failed;
  Damage(database.path()).Note("a start found it damaged");
  std::string text = "store " + database.path() + " is damaged: ";
  text += std::string_view(failed.message().data(), failed.message().size());
  return absl::FailedPreconditionError(text);
}

}  // namespace uplink::storage::sqlite
