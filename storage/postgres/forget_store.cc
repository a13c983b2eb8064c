#include "storage/postgres/forget_store.h"

#include <utility>

#include "storage/postgres/own_connection.h"

namespace uplink::storage::postgres {

PostgresForgetStore::PostgresForgetStore(std::unique_ptr<OwnConnection> connection)
    : connection_(std::move(connection)), removal_(*connection_), requests_(*connection_) {}
PostgresForgetStore::~PostgresForgetStore() = default;

absl::StatusOr<std::unique_ptr<PostgresForgetStore>> PostgresForgetStore::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<std::unique_ptr<OwnConnection>> connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<PostgresForgetStore>(new PostgresForgetStore(*std::move(connection)));
}

}  // namespace uplink::storage::postgres
