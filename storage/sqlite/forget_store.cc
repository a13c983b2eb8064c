#include "storage/sqlite/forget_store.h"

#include <utility>

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<SqliteForgetStore>> SqliteForgetStore::Open(const std::string& path,
                                                                           DamagePtr damage) {
  auto beside = OpenBeside(path, std::move(damage));
  if (!beside.ok()) return beside.status();
  std::unique_ptr<SqliteForgetStore> store(new SqliteForgetStore());
  store->beside_ = *std::move(beside);
  auto removal = SqliteRobotRemoval::Make(*store->beside_.database);
  if (!removal.ok()) return removal.status();
  store->removal_ = *std::move(removal);
  auto requests = SqliteForgetRequests::Make(*store->beside_.database);
  if (!requests.ok()) return requests.status();
  store->requests_ = *std::move(requests);
  return store;
}

}  // namespace uplink::storage::sqlite
