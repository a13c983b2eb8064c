#include "storage/postgres/admin.h"

#include <memory>
#include <utility>

#include "storage/postgres/link/link.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"

namespace uplink::storage::postgres {
namespace {

/// What one step may take: it may have to build an index over a large table.
constexpr std::chrono::minutes kStepTimeout{30};

absl::StatusOr<std::unique_ptr<Connection>> Connect(const AdminOptions& options,
                                                    const Clock& clock) {
  absl::StatusOr<Url> url = ParseUrl(options.url);
  if (!url.ok()) return url.status();
  ConnectionOptions connection;
  connection.url = *std::move(url);
  connection.password_file = options.password_file;
  connection.call_timeout = kStepTimeout;
  connection.session_settings = std::string(kNoTimeouts);
  return Connection::Open(connection, clock);
}

}  // namespace

absl::StatusOr<StoreState> ReadState(const AdminOptions& options, const Clock& clock) {
  const auto connection = Connect(options, clock);
  if (!connection.ok()) return connection.status();
  const absl::StatusOr<ServerFacts> facts = AskServer(**connection, clock);
  if (!facts.ok()) return facts.status();
  const absl::StatusOr<AppliedSchema> schema = ReadSchema(**connection, Migrations());
  if (!schema.ok()) return schema.status();
  StoreState state;
  state.where = (*connection)->where();
  state.server_version = facts->version;
  state.schema_version = schema->version;
  state.schema_fits = schema->missing.status();
  if (schema->missing.ok()) state.steps_missing = schema->missing->size();
  state.schema_needed = static_cast<std::int64_t>(Migrations().size());
  state.fsync = !facts->unsafe;
  state.read_only = facts->read_only;
  state.standby = facts->standby;
  state.clock_offset = facts->clock_offset;
  return state;
}

absl::StatusOr<std::vector<std::string>> MigrateStore(const AdminOptions& options,
                                                      const std::string& grant_to,
                                                      const Clock& clock) {
  const auto connection = Connect(options, clock);
  if (!connection.ok()) return connection.status();
  auto steps = Migrate(**connection, Migrations());
  if (!steps.ok() || grant_to.empty()) return steps;
  absl::Status granted = GrantTo(**connection, grant_to);
  if (!granted.ok()) return granted;
  return steps;
}

}  // namespace uplink::storage::postgres
