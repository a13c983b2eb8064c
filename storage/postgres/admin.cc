#include "storage/postgres/admin.h"

#include <memory>
#include <string_view>
#include <utility>

#include "storage/postgres/data_folder.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"

namespace uplink::storage::postgres {
namespace {

/// How durable a commit of this role is by the server's settings, and how many of our tables lack a
/// right. The table of steps is only read; days of histories are written through their parents.
constexpr std::string_view kAsk =
    "SELECT current_setting('full_page_writes') = 'on', current_setting('synchronous_commit'),"
    " (SELECT count(*) FROM pg_catalog.pg_class AS c"
    " JOIN pg_catalog.pg_namespace AS n ON n.oid = c.relnamespace"
    " WHERE n.nspname = 'uplinkd' AND c.relkind IN ('r', 'p') AND NOT c.relispartition"
    " AND NOT (has_table_privilege(c.oid, 'SELECT') AND (c.relname = 'schema_migrations'"
    " OR has_table_privilege(c.oid, 'INSERT') AND has_table_privilege(c.oid, 'UPDATE')"
    " AND has_table_privilege(c.oid, 'DELETE'))))";

absl::StatusOr<std::unique_ptr<Connection>> Connect(const AdminOptions& options,
                                                    const Clock& clock) {
  absl::StatusOr<Url> url = ParseUrl(options.url);
  if (!url.ok()) return url.status();
  ConnectionOptions connection;
  connection.url = *std::move(url);
  connection.password_file = options.password_file;
  connection.connect_timeout = options.connect_timeout;
  connection.call_timeout = options.call_timeout;
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
  const auto settings = (*connection)->RunOne({kAsk, {}}, "ask for settings and rights");
  if (!settings.ok()) return settings.status();
  absl::StatusOr<std::string> folder = ReadDataFolder(**connection);
  if (!folder.ok()) return folder.status();
  StoreState state;
  state.where = (*connection)->where();
  state.server_version = facts->version;
  state.schema_version = schema->version;
  state.schema_fits = schema->missing.status();
  if (schema->missing.ok()) state.steps_missing = schema->missing->size();
  state.schema_needed = static_cast<std::int64_t>(Migrations().size());
  state.fsync = !facts->unsafe;
  state.full_page_writes = settings->Bool(0, 0);
  state.synchronous_commit = std::string(settings->Bytes(0, 1));
  state.tables_denied = static_cast<std::size_t>(settings->Int(0, 2));
  state.utf8 = facts->utf8;
  state.read_only = facts->read_only;
  state.standby = facts->standby;
  state.clock_offset = facts->clock_offset;
  state.data_folder = *std::move(folder);
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
