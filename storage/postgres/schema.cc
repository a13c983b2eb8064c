#include "storage/postgres/schema.h"

#include <string_view>

namespace uplink::storage::postgres {
namespace {

/// Whether it is the table of steps, which comes first, and whether this role may read it. The
/// other stands for all tables that the first step makes.
constexpr std::string_view kFindTables =
    "SELECT c.relname = 'schema_migrations', has_schema_privilege(n.oid, 'USAGE')"
    " AND has_table_privilege(c.oid, 'SELECT') FROM pg_catalog.pg_class AS c"
    " JOIN pg_catalog.pg_namespace AS n ON n.oid = c.relnamespace WHERE n.nspname = 'uplinkd'"
    " AND c.relname IN ('schema_migrations', 'robots') ORDER BY 1 DESC";
constexpr std::string_view kReadMigrations =
    // An earlier build's table has no column `oldest`.
    "SELECT version, coalesce((to_jsonb(m) ->> 'oldest')::bigint, 0), sha256"
    " FROM uplinkd.schema_migrations AS m ORDER BY version";
/// Held from before the first look until after the last step. The number is ours alone by chance.
constexpr std::string_view kLock = "SELECT pg_advisory_lock(7593126044910271826)";
constexpr std::string_view kUnlock = "SELECT pg_advisory_unlock(7593126044910271826)";

/// Days that a fresh schema has room for: today and the next three.
constexpr std::string_view kMakeFirstDays =
    "SELECT uplinkd.make_partitions((now() AT TIME ZONE 'UTC')::date, 4)";

std::string NameOf(const Connection& connection) {
  return "store postgresql " + connection.where();
}

absl::StatusOr<std::vector<AppliedStep>> ReadApplied(Connection& connection) {
  std::vector<StoreCall> calls;
  calls.push_back({kFindTables, {}});
  const auto found = connection.Run(calls, "look for the schema");
  if (!found.ok()) return found.status();
  const Result& tables = found->front();
  std::vector<AppliedStep> applied;
  if (tables.rows() == 0) return applied;
  if (!tables.Bool(0, 0)) return TablesWithoutSteps(NameOf(connection));
  if (!tables.Bool(0, 1)) {
    return absl::FailedPreconditionError(
        NameOf(connection) +
        ": permission denied for schema uplinkd: run `uplinkctl store migrate --grant-to ROLE` as"
        " its owner, with the role that the server logs in as");
  }
  calls.front() = {kReadMigrations, {}};
  auto read = connection.Run(calls, "read the schema's version");
  if (!read.ok()) return read.status();
  const Result& rows = read->front();
  for (int row = 0; row < rows.rows(); ++row) {
    applied.push_back({rows.Int(row, 0), rows.Int(row, 1), std::string(rows.Bytes(row, 2))});
  }
  if (applied.empty() && tables.rows() > 1) return TablesWithoutSteps(NameOf(connection));
  return applied;
}

absl::Status Apply(Connection& connection, const Migration& migration) {
  std::string sql =
      "BEGIN;\nCREATE SCHEMA IF NOT EXISTS uplinkd;\nSET LOCAL search_path = uplinkd;\n";
  sql += migration.sql;
  sql += "\nINSERT INTO schema_migrations (version, oldest, name, sha256) VALUES (" +
         std::to_string(migration.version) + ", " + std::to_string(migration.oldest) + ", '" +
         migration.name + "', '" + migration.sha256 + "');\nCOMMIT;";
  return connection.RunScript(sql, "migration " + std::string(migration.name));
}

/// The role's name as SQL quotes it.
std::string Quoted(const std::string& role) {
  std::string quoted = "\"";
  for (const char c : role) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string GrantSql(const std::string& role) {
  const std::string to = " TO " + Quoted(role) + ";\n";
  return "GRANT USAGE ON SCHEMA uplinkd" + to +
         "GRANT SELECT, INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA uplinkd" + to +
         "REVOKE INSERT, UPDATE, DELETE ON uplinkd.schema_migrations FROM " + Quoted(role) +
         ";\nGRANT USAGE ON ALL SEQUENCES IN SCHEMA uplinkd" + to +
         "GRANT EXECUTE ON ALL FUNCTIONS IN SCHEMA uplinkd" + to;
}

absl::Status GrantAgain(Connection& connection) {
  std::vector<StoreCall> calls;
  // A role that may write robots is a server's.
  calls.push_back(
      {"SELECT DISTINCT grantee::text FROM information_schema.role_table_grants"
       " WHERE table_schema = 'uplinkd' AND table_name = 'robots'"
       " AND privilege_type = 'INSERT' AND grantee <> current_user",
       {}});
  auto read = connection.Run(calls, "read who may use the schema");
  if (!read.ok()) return read.status();
  for (int row = 0; row < read->front().rows(); ++row) {
    absl::Status granted = GrantTo(connection, std::string(read->front().Bytes(row, 0)));
    if (!granted.ok()) return granted;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> MigrateLocked(Connection& connection,
                                                       std::span<const Migration> migrations) {
  const absl::StatusOr<AppliedSchema> schema = ReadSchema(connection, migrations);
  if (!schema.ok()) return schema.status();
  if (!schema->missing.ok()) return schema->missing.status();
  absl::Status status;
  std::vector<std::string> names;
  for (const Migration& migration : *schema->missing) {
    status = Apply(connection, migration);
    if (!status.ok()) return status;
    names.emplace_back(migration.name);
  }
  if (!names.empty()) status = GrantAgain(connection);
  // A server that commits before it has looked after its partitions finds today's.
  if (status.ok()) status = connection.RunScript(std::string(kMakeFirstDays), "make partitions");
  if (!status.ok()) return status;
  return names;
}

}  // namespace

absl::StatusOr<AppliedSchema> ReadSchema(Connection& connection,
                                         std::span<const Migration> migrations) {
  const absl::StatusOr<std::vector<AppliedStep>> applied = ReadApplied(connection);
  if (!applied.ok()) return applied.status();
  return AppliedSchema{applied->empty() ? 0 : applied->back().version,
                       CheckApplied(NameOf(connection), *applied, migrations)};
}

absl::Status CheckSchema(Connection& connection, std::span<const Migration> migrations) {
  const absl::StatusOr<AppliedSchema> schema = ReadSchema(connection, migrations);
  if (!schema.ok()) return schema.status();
  if (!schema->missing.ok() || schema->missing->empty()) return schema->missing.status();
  return absl::FailedPreconditionError(
      NameOf(connection) + " has schema version " + std::to_string(schema->version) +
      ", and this program needs " + std::to_string(migrations.size()) +
      ": run `uplinkctl store migrate` as its owner, or set store.migrate");
}

absl::StatusOr<std::vector<std::string>> Migrate(Connection& connection,
                                                 std::span<const Migration> migrations) {
  std::vector<StoreCall> calls;
  calls.push_back({kLock, {}});
  const auto locked = connection.Run(calls, "wait for other migrations");
  if (!locked.ok()) return locked.status();
  auto names = MigrateLocked(connection, migrations);
  if (connection.broken()) return names;
  calls.front() = {kUnlock, {}};
  const auto unlocked = connection.Run(calls, "end the migration");
  if (names.ok() && !unlocked.ok()) return unlocked.status();
  return names;
}

absl::Status GrantTo(Connection& connection, const std::string& role) {
  return connection.RunScript(GrantSql(role), "grant to role " + role);
}

}  // namespace uplink::storage::postgres
