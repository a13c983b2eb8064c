#include "storage/sqlite/forget_store.h"

#include <utility>

#include "storage/sqlite/open_beside.h"

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<SqliteForgetStore>> SqliteForgetStore::Open(
    const std::string& path) {
  auto database = OpenBeside(path);
  if (!database.ok()) return database.status();
  std::unique_ptr<SqliteForgetStore> store(new SqliteForgetStore());
  store->database_ = *std::move(database);
  auto removal = SqliteRobotRemoval::Make(*store->database_);
  if (!removal.ok()) return removal.status();
  store->removal_ = *std::move(removal);
  auto requests = SqliteForgetRequests::Make(*store->database_);
  if (!requests.ok()) return requests.status();
  store->requests_ = *std::move(requests);
  return store;
}

}  // namespace uplink::storage::sqlite
