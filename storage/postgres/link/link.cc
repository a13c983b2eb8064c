#include "storage/postgres/link/link.h"

#include <string_view>
#include <utility>
#include <vector>

#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kAsk =
    "SELECT current_setting('server_version_num')::bigint, current_setting('fsync') = 'off',"
    " current_setting('transaction_read_only') = 'on', pg_is_in_recovery(), clock_timestamp(),"
    " current_setting('server_encoding') = 'UTF8',"
    " (extract(epoch FROM pg_postmaster_start_time()) * 1000000)::bigint::text || '.' ||"
    " (SELECT oid FROM pg_database WHERE datname = current_database())::text";

constexpr std::string_view kRaiseSequences = "SELECT uplinkd.raise_sequences()";
constexpr std::string_view kMakeToday =
    "SELECT uplinkd.make_partitions((clock_timestamp() AT TIME ZONE 'UTC')::date, 1)";
/// What one migration may take.
constexpr std::chrono::minutes kMigrationTimeout{30};

absl::Status Unfit(const Connection& connection, const std::string& text) {
  return absl::FailedPreconditionError("store postgresql " + connection.where() + " " + text);
}

}  // namespace

absl::StatusOr<Connection*> Link::Get() {
  if (connected()) return connection_.get();
  connection_ = nullptr;
  if (to_migrate_) {
    absl::Status migrated = MigrateFirst();
    if (!migrated.ok()) return migrated;
    to_migrate_ = false;
  }
  auto opened = Connection::Open(options_.connection, clock_);
  if (!opened.ok()) return opened.status();
  absl::Status checked = Check(**opened);
  if (!checked.ok()) return checked;
  connection_ = *std::move(opened);
  ++connections_;
  return connection_.get();
}

absl::StatusOr<ServerFacts> AskServer(Connection& connection, const Clock& clock) {
  std::vector<StoreCall> calls;
  calls.push_back({kAsk, {}});
  const auto answer = connection.Run(calls, "ask the server what it is");
  if (!answer.ok()) return answer.status();
  const Result& row = answer->front();
  ServerFacts facts;
  facts.version = row.Int(0, 0);
  facts.unsafe = row.Bool(0, 1);
  facts.read_only = row.Bool(0, 2);
  facts.standby = row.Bool(0, 3);
  facts.clock_offset = row.Time(0, 4) - clock.System();
  facts.utf8 = row.Bool(0, 5);
  facts.run = std::string(row.Bytes(0, 6));
  return facts;
}

absl::Status Link::Check(Connection& connection) {
  const absl::StatusOr<ServerFacts> facts = AskServer(connection, clock_);
  if (!facts.ok()) return facts.status();
  facts_ = *facts;
  if (facts_.version < kServerVersionMin) {
    return Unfit(connection, "is version " + std::to_string(facts_.version / 10'000) +
                                 "; 13 and newer are supported");
  }
  if (!facts_.utf8) {
    return Unfit(connection, "is not encoded in UTF8: it would refuse texts of some languages");
  }
  if (options_.purpose == Purpose::kWrite) {
    if (facts_.unsafe && !options_.accept_unsafe) {
      return Unfit(connection,
                   "has fsync = off: an ack would not be durable; turn it on, or accept the loss"
                   " with store.accept_unsafe = true");
    }
    if (facts_.standby) return Unfit(connection, "is a standby: it takes no writes");
    if (facts_.read_only) {
      return Unfit(connection, "is read-only (default_transaction_read_only): it takes no writes");
    }
  }
  absl::Status fits = CheckSchema(connection, Migrations());
  if (absl::IsUnimplemented(fits) && options_.when_shut_out && std::exchange(shut_out_, true)) {
    return absl::OkStatus();
  }
  if (!fits.ok() || options_.purpose == Purpose::kRead) return fits;
  std::vector<StoreCall> calls;
  calls.push_back({kRaiseSequences, {}});
  absl::Status raised = connection.Run(calls, "raise sequences").status();
  if (!raised.ok()) return raised;
  // Rows of today have their partition from the first on. If not, they lie in the default one.
  calls.clear();
  calls.push_back({kMakeToday, {}});
  const absl::Status made = connection.Run(calls, "make partitions").status();
  return connection.broken() ? made : absl::OkStatus();
}

absl::Status Link::MigrateFirst() {
  ConnectionOptions options = options_.connection;
  options.call_timeout = kMigrationTimeout;
  options.session_settings = std::string(kNoTimeouts);
  auto connection = Connection::Open(options, clock_);
  if (!connection.ok()) return connection.status();
  return Migrate(**connection, Migrations()).status();
}

std::string SessionSettings(Purpose purpose, milliseconds statement_timeout) {
  const std::string timeout = std::to_string(statement_timeout.count());
  std::string settings = "SET search_path = uplinkd, pg_catalog; SET TimeZone = 'UTC';";
  settings += " SET statement_timeout = " + timeout + ";";
  settings += " SET lock_timeout = " + timeout + ";";
  // A server process whose client is gone must not hold its locks for long.
  settings += " SET idle_in_transaction_session_timeout = " + timeout + ";";
  // Quiet hours end no session of ours. The setting is there from PostgreSQL 14 on.
  settings +=
      " SELECT pg_catalog.set_config(name, '0', false) FROM pg_catalog.pg_settings"
      " WHERE name = 'idle_session_timeout';";
  settings +=
      " SET tcp_keepalives_idle = 15; SET tcp_keepalives_interval = 5;"
      " SET tcp_keepalives_count = 3;";
  if (purpose == Purpose::kRead) {
    // Each read is planned for its own range of time.
    settings += " SET default_transaction_read_only = on; SET plan_cache_mode = force_custom_plan;";
    return settings;
  }
  settings += " SET synchronous_commit = on;";
  // A batch looks rows up by their keys, however small a table was when the plan was made.
  settings +=
      " SET plan_cache_mode = force_generic_plan; SET enable_seqscan = off;"
      " SET enable_hashjoin = off; SET enable_mergejoin = off; SET jit = off;"
      // The newest version of a key is met first, in the order of the index. Sorts stay: without
      // them, robots that are locked in order would be looked for among all that there are.
      " SET enable_bitmapscan = off;";
  return settings;
}

}  // namespace uplink::storage::postgres
