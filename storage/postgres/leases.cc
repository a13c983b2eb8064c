#include "storage/leases.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/postgres/migrations.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"
#include "storage/read_row.h"

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
    "SELECT r.ruri, r.fleet, r.owner, r.held_since, p.presence, p.changed_at, p.parked_until,"
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

Lease LeaseIn(const ResultRow& row) {
  return {.process = row.Uuid(0).bytes(),
          .card = {TextIn(row, 1), TextIn(row, 2)},
          .counter = NumberIn(row, 3),
          .released = row.Bool(4),
          .renewed_ago = std::chrono::seconds(row.Int(5))};
}

ForeignRobot ForeignIn(const ResultRow& row) {
  ForeignRobot robot{.robot = {TextIn(row, 0), TextIn(row, 1)},
                     .holder = row.Uuid(2).bytes(),
                     .held_since = NumberIn(row, 3),
                     .presence = PresenceIn(row, 4),
                     .last_session = SessionIn(row, 8)};
  if (!row.Null(7)) robot.written_at = row.Time(7);
  return robot;
}

class PostgresLeases final : public Leases {
 public:
  PostgresLeases(std::unique_ptr<OwnConnection> connection, const ProcessId& process)
      : process_(process), connection_(std::move(connection)) {}

  std::string ServerRun() const override { return connection_->server_run(); }

  absl::Status Renew(const ProcessCard& card) override {
    const auto renewed =
        connection_->Write(StoreCallOf(kRenew, process_, card.name, card.life), "renew the lease");
    if (!renewed.ok()) return renewed.status();
    absl::Status let_in = CheckOldest("the store", renewed->Int(0, 0), renewed->Int(0, 1),
                                      static_cast<std::int64_t>(Migrations().size()));
    if (!let_in.ok() || forgot_) return let_in;
    const auto hours = static_cast<std::int32_t>(kLeaseKept.count());
    const auto forgot = connection_->Write(StoreCallOf(kForget, hours), "forget old leases");
    forgot_ = forgot.ok();
    return forgot.status();
  }
  absl::Status Release() override {
    return connection_->Write(StoreCallOf(kRelease, process_), "release the lease").status();
  }
  absl::StatusOr<std::vector<Lease>> Read() override {
    const auto rows = connection_->Write(
        StoreCallOf(kRead, std::int64_t{kLeasesMax}, static_cast<std::int32_t>(kCardTextMax)),
        "read leases");
    if (!rows.ok()) return rows.status();
    return rows->All(LeaseIn);
  }
  absl::StatusOr<std::vector<ForeignRobot>> RobotsOfOthers(std::string_view after) override {
    const auto rows = connection_->Write(
        StoreCallOf(kRobotsOfOthers, process_, after, std::int64_t{kForeignRobotsMax}),
        "read who holds robots");
    if (!rows.ok()) return rows.status();
    return rows->All(ForeignIn);
  }

 private:
  const ProcessId process_;
  const std::unique_ptr<OwnConnection> connection_;
  bool forgot_ = false;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Leases>> MakeLeases(const StoreOptions& options,
                                                   const Clock& clock) {
  // Where a step shuts this program out, Release still works: columns are only added.
  auto connection = OwnConnection::Make(options, clock, /*when_shut_out=*/true);
  if (!connection.ok()) return connection.status();
  return std::make_unique<PostgresLeases>(*std::move(connection), options.process);
}

}  // namespace uplink::storage::postgres
