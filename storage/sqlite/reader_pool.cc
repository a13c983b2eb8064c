#include "storage/sqlite/reader_pool.h"

#include "storage/sqlite/migrations.h"
#include "storage/sqlite/schema.h"

namespace uplink::storage::sqlite {

absl::Status SqliteReader::Pool::Fill() {
  for (std::size_t i = 0; i < options_.connections; ++i) {
    auto database = Database::Open(path_, Access::kRead, options_.wait_max);
    if (!database.ok()) return database.status();
    absl::Status status = CheckFile(**database, Migrations());
    // Reads the schema; refuses what is older, since a reader cannot migrate.
    if (status.ok()) status = Migrate(**database, Migrations(), IfOlder::kRefuse);
    if (!status.ok()) return status;
    free_.push_back(*std::move(database));
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
