#include "storage/postgres/leases.h"

#include <string>
#include <utility>

#include "storage/numbers.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/own_connection.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kRenew =
    "INSERT INTO uplinkd.processes AS p (process, name, life, counter, released, renewed_at)"
    " VALUES ($1::uuid, $2::text, $3::text, 1, false, now()) ON CONFLICT (process) DO UPDATE SET"
    " name = excluded.name, life = excluded.life, counter = p.counter + 1,"
    " renewed_at = now() RETURNING (SELECT max(m.oldest) FROM uplinkd.schema_migrations AS m),"
    " (SELECT max(m.version) FROM uplinkd.schema_migrations AS m)";
// Once in the life of a process: those that left long ago.
constexpr std::string_view kForget =
    "DELETE FROM uplinkd.processes AS p WHERE p.renewed_at < now() - make_interval(hours => "
    "$1::int)"
    " AND NOT EXISTS (SELECT 1 FROM uplinkd.robots AS r WHERE r.owner = p.process)";
constexpr std::string_view kRelease =
    "UPDATE uplinkd.processes SET released = true WHERE process = $1::uuid";
constexpr std::string_view kRead =
    "SELECT process, left(name, $2::int), left(life, $2::int), counter, released,"
    " greatest(0, extract(epoch FROM clock_timestamp() - renewed_at))::int8"
    " FROM uplinkd.processes ORDER BY renewed_at DESC, process LIMIT $1::bigint";
constexpr std::string_view kRobotsOfOthers =
    "SELECT r.ruri, r.fleet, r.owner, r.held_since, p.presence, p.changed_at,"
    " greatest(p.changed_at, l.written_at), coalesce(s.session, l.session),"
    " CASE WHEN s.session IS NULL OR s.session = l.session"
    " THEN greatest(s.cursor_seq, l.settled_seq) ELSE s.cursor_seq END FROM uplinkd.robots AS r"
    " LEFT JOIN uplinkd.presence_latest AS p ON p.ruri = r.ruri"
    " LEFT JOIN uplinkd.live AS l ON l.ruri = r.ruri"
    // Looked for where no checkpoint of the present hold names one: there may be many dead versions
    // of its row.
    " LEFT JOIN LATERAL (SELECT session, cursor_seq FROM uplinkd.sessions"
    " WHERE (l.session IS NULL OR l.held_since <> r.held_since) AND ruri = r.ruri"
    " ORDER BY last_used DESC, session DESC LIMIT 1) AS s ON true"
    // Those that stand for no robot (origin.h) are left out.
    " WHERE r.owner <> $1::uuid AND left(r.ruri, 10) <> 'cyberwave:'"
    " AND r.ruri > $2::text ORDER BY r.ruri LIMIT $3::bigint";

}  // namespace

struct PostgresLeases::Impl {
  ProcessId process;
  std::unique_ptr<OwnConnection> connection;
  bool forgot = false;
};

PostgresLeases::PostgresLeases(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresLeases::~PostgresLeases() = default;

absl::StatusOr<std::unique_ptr<PostgresLeases>> PostgresLeases::Make(const StoreOptions& options,
                                                                     const Clock& clock) {
  absl::StatusOr<std::unique_ptr<OwnConnection>> connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<PostgresLeases>(new PostgresLeases(
      std::make_unique<Impl>(Impl{options.process, *std::move(connection), false})));
}

std::string PostgresLeases::ServerRun() const { return impl_->connection->server_run(); }

absl::Status PostgresLeases::Renew(const ProcessCard& card) {
  StoreCall renew{kRenew, {}};
  renew.parameters.Uuid(model::SessionId(impl_->process));
  renew.parameters.Text(card.name);
  renew.parameters.Text(card.life);
  const auto renewed = impl_->connection->Write(std::move(renew), "renew the lease");
  if (!renewed.ok()) return renewed.status();
  absl::Status let_in = CheckOldest("the store", renewed->Int(0, 0), renewed->Int(0, 1),
                                    static_cast<std::int64_t>(Migrations().size()));
  if (!let_in.ok() || impl_->forgot) return let_in;
  StoreCall forget{kForget, {}};
  forget.parameters.Int4(static_cast<std::int32_t>(kLeaseKept.count()));
  const auto forgot = impl_->connection->Write(std::move(forget), "forget old leases");
  impl_->forgot = forgot.ok();
  return forgot.status();
}

absl::Status PostgresLeases::Release() {
  StoreCall release{kRelease, {}};
  release.parameters.Uuid(model::SessionId(impl_->process));
  return impl_->connection->Write(std::move(release), "release the lease").status();
}

absl::StatusOr<std::vector<Lease>> PostgresLeases::Read() {
  StoreCall read{kRead, {}};
  read.parameters.Int8(std::int64_t{kLeasesMax});
  read.parameters.Int4(static_cast<std::int32_t>(kCardTextMax));
  const auto rows = impl_->connection->Write(std::move(read), "read leases");
  if (!rows.ok()) return rows.status();
  std::vector<Lease> leases(static_cast<std::size_t>(rows->rows()));
  for (int row = 0; row < rows->rows(); ++row) {
    Lease& lease = leases[static_cast<std::size_t>(row)];
    lease.process = rows->Uuid(row, 0).bytes();
    lease.card = {std::string(rows->Bytes(row, 1)), std::string(rows->Bytes(row, 2))};
    lease.counter = static_cast<std::uint64_t>(rows->Int(row, 3));
    lease.released = rows->Bool(row, 4);
    lease.renewed_ago = std::chrono::seconds(rows->Int(row, 5));
  }
  return leases;
}

absl::StatusOr<std::vector<ForeignRobot>> PostgresLeases::RobotsOfOthers(std::string_view after) {
  StoreCall read{kRobotsOfOthers, {}};
  read.parameters.Uuid(model::SessionId(impl_->process));
  read.parameters.Text(after);
  read.parameters.Int8(std::int64_t{kForeignRobotsMax});
  const auto rows = impl_->connection->Write(std::move(read), "read who holds robots");
  if (!rows.ok()) return rows.status();
  std::vector<ForeignRobot> robots(static_cast<std::size_t>(rows->rows()));
  for (int row = 0; row < rows->rows(); ++row) {
    ForeignRobot& robot = robots[static_cast<std::size_t>(row)];
    robot.robot = {std::string(rows->Bytes(row, 0)), std::string(rows->Bytes(row, 1))};
    robot.holder = rows->Uuid(row, 2).bytes();
    robot.held_since = static_cast<Epoch>(rows->Int(row, 3));
    if (!rows->Null(row, 4)) {
      robot.presence = StoredPresence{PresenceOf(rows->Int(row, 4)), rows->Time(row, 5)};
    }
    if (!rows->Null(row, 6)) robot.written_at = rows->Time(row, 6);
    if (!rows->Null(row, 7)) {
      robot.last_session = {rows->Uuid(row, 7), static_cast<model::Seq>(rows->Int(row, 8))};
    }
  }
  return robots;
}

}  // namespace uplink::storage::postgres
