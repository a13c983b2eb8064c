#include "storage/postgres/reader.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "storage/numbers.h"
#include "storage/postgres/data_folder.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/live_rows.h"
#include "storage/postgres/read/lists.h"
#include "storage/postgres/read/pages.h"
#include "storage/postgres/read/reader_pool.h"
#include "storage/postgres/tables/rejects_sql.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {
namespace {

/// The server may have gone to another machine.
constexpr std::chrono::seconds kFolderEvery{10};
/// After a failure it is asked for so much later: each try may take a connect's time, on the thread
/// that answers operators.
constexpr std::chrono::minutes kFolderLater{1};
/// Robots of which the latest is read in one round trip: their bodies come at once.
constexpr std::size_t kRobotsPerTrip = 16;

// Commits touch a robot's sessions, not its own row.
constexpr std::string_view kRobots =
    "SELECT r.ruri, r.fleet, r.first_seen, greatest(r.last_seen, s.last_used, l.last_sign_at) AS"
    " heard_at, p.presence,"
    " p.changed_at, s.session, greatest(s.cursor_seq,"
    " CASE WHEN l.session = s.session THEN l.settled_seq END), r.owner"
    " FROM uplinkd.robots AS r LEFT JOIN uplinkd.presence_latest AS p ON p.ruri = r.ruri"
    " LEFT JOIN LATERAL (SELECT session, cursor_seq, last_used FROM uplinkd.sessions"
    " WHERE ruri = r.ruri ORDER BY last_used DESC, session DESC LIMIT 1) AS s ON true"
    " LEFT JOIN uplinkd.live AS l ON l.ruri = r.ruri"
    // Those that stand for no robot (origin.h).
    " WHERE left(r.ruri, 10) <> 'cyberwave:'"
    " ORDER BY heard_at DESC, r.ruri LIMIT $1::bigint";
constexpr std::string_view kRobotCount =
    "SELECT count(*) FROM uplinkd.robots WHERE left(ruri, 10) <> 'cyberwave:'";
// More bytes than characters.
constexpr std::string_view kFleetsBeyondAscii =
    "SELECT DISTINCT fleet COLLATE \"C\" AS name FROM uplinkd.robots"
    " WHERE left(ruri, 10) <> 'cyberwave:' AND octet_length(fleet) > char_length(fleet)"
    " ORDER BY name LIMIT $1::bigint";
constexpr std::string_view kActiveFaultCounts =
    "SELECT ruri, count(*), severity::bigint FROM uplinkd.faults_active"
    " WHERE ruri = ANY ($1::text[]) GROUP BY ruri, severity ORDER BY ruri";
constexpr std::string_view kQuarantineDropped =
    "SELECT reason, count FROM uplinkd.quarantine_dropped WHERE ruri = $1::text ORDER BY reason";
// A session's row is looked for from the greatest part down (see the migration of session parts).
constexpr SqlText kRejects = {
    "SELECT q.seq, q.reason, q.field, q.detail"
    " FROM (SELECT $1::text, $2::uuid, $3::bigint) AS u (ruri, session, above)"
    " CROSS JOIN LATERAL (SELECT $5::bigint AS through, l.first_entry FROM uplinkd.sessions AS l"
    " WHERE l.ruri = u.ruri AND l.session = u.session ORDER BY l.part DESC LIMIT 1) AS s",
    kJoinRejects, " ORDER BY q.seq LIMIT $4::bigint"};
constexpr std::string_view kLatest =
    "SELECT kind, received_at, body FROM uplinkd.latest"
    " WHERE ruri = $1::text AND ($2::int >> kind) & 1 = 1 ORDER BY kind";

/// Reads a row of kRobots.
RobotRow RobotOf(const Result& rows, int row) {
  RobotRow robot{.robot = {std::string(rows.Bytes(row, 0)), std::string(rows.Bytes(row, 1))},
                 .first_seen = rows.Time(row, 2),
                 .last_seen = rows.Time(row, 3)};
  if (!rows.Null(row, 4)) {
    robot.last_presence = PresenceOf(rows.Int(row, 4));
    robot.presence_since = rows.Time(row, 5);
  }
  if (!rows.Null(row, 6)) {
    robot.last_session = {rows.Uuid(row, 6), static_cast<model::Seq>(rows.Int(row, 7))};
  }
  robot.holder = rows.Uuid(row, 8).bytes();
  return robot;
}

/// An answer a robot, in one round trip.
absl::StatusOr<std::vector<Result>> ReadLatest(Connection& connection,
                                               std::span<const std::string> ruris,
                                               LatestKindSet kinds) {
  std::vector<StoreCall> calls;
  calls.reserve(ruris.size());
  for (const std::string& ruri : ruris) {
    StoreCall call{kLatest, {}};
    call.parameters.Text(ruri);
    call.parameters.Int4(static_cast<std::int32_t>(kinds));
    calls.push_back(std::move(call));
  }
  return connection.Run(calls, "read");
}

/// Adds a robot's rows; returns their bytes.
std::size_t TakeLatest(const Result& rows, const std::string& ruri, std::vector<LatestRow>& all) {
  std::size_t bytes = 0;
  for (int row = 0; row < rows.rows(); ++row) {
    bytes += rows.RowBytes(row);
    all.push_back({ruri, static_cast<LatestKind>(rows.Int(row, 0)), std::string(rows.Bytes(row, 2)),
                   rows.Time(row, 1)});
  }
  return bytes;
}

}  // namespace

PostgresReader::PostgresReader(std::unique_ptr<Pool> pool) : pool_(std::move(pool)) {}
PostgresReader::~PostgresReader() = default;

absl::StatusOr<std::unique_ptr<PostgresReader>> PostgresReader::Open(const ReaderOptions& options,
                                                                     const Clock& clock) {
  const absl::StatusOr<Link::Options> link = LinkOptionsOf(options);
  if (!link.ok()) return link.status();
  return std::unique_ptr<PostgresReader>(
      new PostgresReader(std::make_unique<Pool>(options, *link, clock)));
}

absl::StatusOr<milliseconds> PostgresReader::OldestSnapshot() {
  const absl::StatusOr<Horizon> horizon =
      pool_->With([](Connection& connection) { return ReadHorizon(connection); });
  if (!horizon.ok()) return horizon.status();
  return horizon_age_.Note(*horizon, pool_->clock().Steady());
}

absl::StatusOr<std::optional<DiskSpace>> PostgresReader::Space() {
  const SteadyTime now = pool_->clock().Steady();
  if (!folder_asked_ || now - *folder_asked_ >= kFolderEvery) {
    folder_asked_ = now;
    absl::StatusOr<std::string> folder =
        pool_->With([](Connection& connection) { return ReadDataFolder(connection); });
    if (folder.ok()) {
      folder_ = *std::move(folder);
    } else {
      // While the server is away, its disk is where it was; and who asks for rows waits long
      // enough.
      folder_asked_ = now + kFolderLater;
    }
  }
  if (folder_.empty()) return std::nullopt;
  return DiskSpaceOf(folder_);
}

absl::StatusOr<std::vector<RobotRow>> PostgresReader::Robots(std::uint32_t robots_max) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<RobotRow>> {
    OwnedStoreCall call{std::string(kRobots), {}};
    call.parameters.Int8(std::int64_t{robots_max});
    const auto rows = RunOne(connection, std::move(call));
    if (!rows.ok()) return rows.status();
    std::vector<RobotRow> robots;
    robots.reserve(static_cast<std::size_t>(rows->rows()));
    for (int row = 0; row < rows->rows(); ++row) {
      robots.push_back(RobotOf(*rows, row));
    }
    return robots;
  });
}

absl::StatusOr<std::size_t> PostgresReader::RobotCount() {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::size_t> {
    const auto rows = RunOne(connection, {std::string(kRobotCount), {}});
    if (!rows.ok()) return rows.status();
    return static_cast<std::size_t>(rows->Int(0, 0));
  });
}

absl::StatusOr<std::vector<std::string>> PostgresReader::FleetsBeyondAscii(
    std::uint32_t fleets_max) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<std::string>> {
    OwnedStoreCall call{std::string(kFleetsBeyondAscii), {}};
    call.parameters.Int8(std::int64_t{fleets_max});
    const auto rows = RunOne(connection, std::move(call));
    if (!rows.ok()) return rows.status();
    std::vector<std::string> fleets;
    fleets.reserve(static_cast<std::size_t>(rows->rows()));
    for (int row = 0; row < rows->rows(); ++row) fleets.emplace_back(rows->Bytes(row, 0));
    return fleets;
  });
}

absl::StatusOr<std::vector<DroppedRow>> PostgresReader::QuarantineDropped(const std::string& ruri) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<DroppedRow>> {
    OwnedStoreCall call{std::string(kQuarantineDropped), {}};
    call.parameters.Text(ruri);
    const auto rows = RunOne(connection, std::move(call));
    if (!rows.ok()) return rows.status();
    std::vector<DroppedRow> dropped;
    dropped.reserve(static_cast<std::size_t>(rows->rows()));
    for (int row = 0; row < rows->rows(); ++row) {
      dropped.push_back(
          {ReasonOf(rows->Int(row, 0)), static_cast<std::uint64_t>(rows->Int(row, 1))});
    }
    return dropped;
  });
}

absl::StatusOr<std::vector<StoredReject>> PostgresReader::Rejects(const RejectsQuery& query) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<StoredReject>> {
    OwnedStoreCall call{std::string(kRejects.view()), {}};
    call.parameters.Text(query.ruri);
    call.parameters.Uuid(query.session);
    call.parameters.Int8(static_cast<std::int64_t>(query.above));
    call.parameters.Int8(static_cast<std::int64_t>(query.rows_max));
    call.parameters.Int8(static_cast<std::int64_t>(query.through));
    const auto rows = RunOne(connection, std::move(call));
    if (!rows.ok()) return rows.status();
    std::vector<StoredReject> rejects;
    rejects.reserve(static_cast<std::size_t>(rows->rows()));
    for (int row = 0; row < rows->rows(); ++row) {
      rejects.push_back({static_cast<model::Seq>(rows->Int(row, 0)),
                         {ReasonOf(rows->Int(row, 1)), std::string(rows->Bytes(row, 2)),
                          std::string(rows->Bytes(row, 3))}});
    }
    return rejects;
  });
}

absl::StatusOr<std::vector<ActiveFaults>> PostgresReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<ActiveFaults>> {
    Array robots{Type::kText};
    for (const std::string& ruri : ruris) robots.Text(ruri);
    OwnedStoreCall call{std::string(kActiveFaultCounts), {}};
    call.parameters.Add(std::move(robots));
    const auto rows = RunOne(connection, std::move(call));
    if (!rows.ok()) return rows.status();
    std::vector<ActiveFaults> counts;
    for (int row = 0; row < rows->rows(); ++row) {
      const std::string_view ruri = rows->Bytes(row, 0);
      if (counts.empty() || counts.back().ruri != ruri) counts.emplace_back().ruri = ruri;
      counts.back().Add(rows->Int(row, 2), rows->Int(row, 1));
    }
    return counts;
  });
}

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                \
  absl::StatusOr<Page<Row>> PostgresReader::Name(const Query& query) { \
    return pool_->With([&query](Connection& connection) {              \
      return ReadList<PageKind::k##Name>(connection, query);           \
    });                                                                \
  }
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
// NOLINTEND(bugprone-macro-parentheses)

absl::StatusOr<Reader::LatestRows> PostgresReader::Latest(std::span<const std::string> ruris,
                                                          LatestKindSet kinds) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<LatestRows> {
    LatestRows latest;
    std::size_t bytes = 0;
    while (latest.complete < ruris.size() && bytes < kPageBytesMax) {
      const std::size_t left = ruris.size() - latest.complete;
      const auto some = ruris.subspan(latest.complete, std::min(kRobotsPerTrip, left));
      const auto results = ReadLatest(connection, some, kinds);
      if (!results.ok()) return results.status();
      for (std::size_t i = 0; i < some.size() && bytes < kPageBytesMax; ++i) {
        bytes += TakeLatest((*results)[i], some[i], latest.rows);
        ++latest.complete;
      }
    }
    return latest;
  });
}

absl::StatusOr<Reader::LiveRows> PostgresReader::LiveOf(std::span<const std::string> ruris) {
  return pool_->With([&](Connection& connection) { return ReadLiveOf(connection, ruris); });
}

}  // namespace uplink::storage::postgres
