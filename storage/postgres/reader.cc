#include "storage/postgres/reader.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "storage/postgres/data_folder.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/link_options.h"
#include "storage/postgres/live_rows.h"
#include "storage/postgres/pages.h"
#include "storage/postgres/tables/rejects_sql.h"
#include "storage/read_row.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {
namespace {

/// The server may have gone to another machine.
constexpr std::chrono::seconds kFolderEvery{10};
/// After a failure it is asked for so much later: each try may take a connect's time, on the thread
/// that answers operators.
constexpr std::chrono::minutes kFolderLater{1};
/// Robots whose latest messages are read in one round trip: their bodies come at once.
constexpr std::size_t kRobotsPerTrip = 16;

// Commits touch a robot's sessions, or its claim, not its own row.
constexpr std::string_view kRobots =
    "SELECT r.ruri, r.fleet, r.first_seen,"
    " greatest(r.last_seen, s.last_used, l.last_sign_at, c.last_used) AS heard_at, p.presence,"
    " p.changed_at, p.parked_until, s.session, greatest(s.cursor_seq,"
    " CASE WHEN l.session = s.session THEN l.settled_seq END), r.owner,"
    " (c.ruri IS NOT NULL)::int"
    " FROM uplinkd.robots AS r LEFT JOIN uplinkd.presence_latest AS p ON p.ruri = r.ruri"
    " LEFT JOIN LATERAL (SELECT session, cursor_seq, last_used FROM uplinkd.sessions"
    " WHERE ruri = r.ruri ORDER BY last_used DESC, session DESC LIMIT 1) AS s ON true"
    " LEFT JOIN uplinkd.live AS l ON l.ruri = r.ruri"
    " LEFT JOIN uplinkd.drone_claims AS c ON c.ruri = r.ruri"
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
constexpr std::string_view kOpenRequestCounts =
    "SELECT ruri, count(*) FROM uplinkd.operator_requests"
    " WHERE ruri = ANY ($1::text[]) AND is_open GROUP BY ruri ORDER BY ruri";
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

/// What `read` makes of each row of the answer.
template <typename Read>
auto ReadAll(Connection& connection, StoreCall call, const Read& read)
    -> absl::StatusOr<decltype(std::declval<Result&>().All(read))> {
  const auto rows = connection.RunOne(std::move(call), "read");
  if (!rows.ok()) return rows.status();
  return rows->All(read);
}

/// One answer per robot, in one round trip.
absl::StatusOr<std::vector<Result>> ReadLatest(Connection& connection,
                                               std::span<const std::string> ruris,
                                               LatestKindSet kinds) {
  std::vector<StoreCall> calls;
  calls.reserve(ruris.size());
  for (const std::string& ruri : ruris) {
    calls.push_back(StoreCallOf(kLatest, ruri, static_cast<std::int32_t>(kinds)));
  }
  return connection.Run(calls, "read");
}

/// Adds a robot's rows; returns their bytes.
std::size_t TakeLatest(const Result& rows, const std::string& ruri, std::vector<LatestRow>& all) {
  std::size_t bytes = 0;
  for (const ResultRow& row : rows) {
    bytes += row.TextBytes();
    all.push_back(LatestIn(row, ruri));
  }
  return bytes;
}

}  // namespace

/// The connections of a reader that no read uses now. Thread-safe.
class PostgresReader::Pool final {
 public:
  Pool(const ReaderOptions& options, const Link::Options& link, const Clock& clock)
      : options_(options), clock_(clock) {
    for (std::size_t i = 0; i < options.connections; ++i) {
      free_.push_back(std::make_unique<Link>(link, clock));
    }
  }

  [[nodiscard]] const Clock& clock() const { return clock_; }
  /// Runs `read` with a connection; waits for one. Once more, with a new one, if that had died
  /// while it was idle.
  template <typename Read>
  auto With(const Read& read) -> decltype(read(std::declval<Connection&>())) {
    std::unique_ptr<Link> link;
    {
      std::unique_lock lock(mutex_);
      if (failed_until_ && clock_.Steady() < *failed_until_) return failure_;
      if (!returned_.wait_for(lock, options_.wait_max, [this] { return !free_.empty(); })) {
        return absl::UnavailableError("all reading connections of the store are in use");
      }
      link = std::move(free_.back());
      free_.pop_back();
    }
    auto result = ReadAgainIfDied(*link, [&] { return Try(*link, read); });
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(link));
    returned_.notify_one();
    return result;
  }

 private:
  template <typename Read>
  auto Try(Link& link, const Read& read) -> decltype(read(std::declval<Connection&>())) {
    const absl::StatusOr<Connection*> connection = link.Get();
    if (!connection.ok()) {
      NoteFailure(connection.status());
      return connection.status();
    }
    return read(**connection);
  }
  void NoteFailure(const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    failure_ = status;
    failed_until_ = clock_.Steady() + options_.retry_pause;
  }

  const ReaderOptions options_;
  const Clock& clock_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Link>> free_;
  absl::Status failure_;
  std::optional<SteadyTime> failed_until_;
};

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
  const auto horizon = pool_->With([](Connection& connection) { return ReadHorizon(connection); });
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
  return pool_->With([&](Connection& connection) {
    return ReadAll(connection, StoreCallOf(kRobots, std::int64_t{robots_max}), RobotIn<ResultRow>);
  });
}

absl::StatusOr<std::size_t> PostgresReader::RobotCount() {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::size_t> {
    const auto rows = connection.RunOne(StoreCallOf(kRobotCount), "read");
    if (!rows.ok()) return rows.status();
    return static_cast<std::size_t>(rows->Int(0, 0));
  });
}

absl::StatusOr<std::vector<std::string>> PostgresReader::FleetsBeyondAscii(
    std::uint32_t fleets_max) {
  return pool_->With([&](Connection& connection) {
    return ReadAll(connection, StoreCallOf(kFleetsBeyondAscii, std::int64_t{fleets_max}),
                   [](const ResultRow& row) { return TextIn(row, 0); });
  });
}

absl::StatusOr<std::vector<DroppedRow>> PostgresReader::QuarantineDropped(const std::string& ruri) {
  return pool_->With([&](Connection& connection) {
    return ReadAll(connection, StoreCallOf(kQuarantineDropped, ruri), DroppedIn<ResultRow>);
  });
}

absl::StatusOr<std::vector<StoredReject>> PostgresReader::Rejects(const RejectsQuery& query) {
  return pool_->With([&](Connection& connection) {
    return ReadAll(connection,
                   StoreCallOf(kRejects.view(), query.ruri, query.session, query.above,
                               query.rows_max, query.through),
                   [](const ResultRow& row) { return RejectIn(row); });
  });
}

absl::StatusOr<std::vector<ActiveFaults>> PostgresReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Connection& connection) -> absl::StatusOr<std::vector<ActiveFaults>> {
    Array robots{Type::kText};
    for (const std::string& ruri : ruris) robots.Text(ruri);
    const auto rows = connection.RunOne(StoreCallOf(kActiveFaultCounts, &robots), "read");
    if (!rows.ok()) return rows.status();
    std::vector<ActiveFaults> counts;
    for (const ResultRow& row : *rows) {
      const std::string_view ruri = row.Bytes(0);
      if (counts.empty() || counts.back().ruri != ruri) counts.emplace_back().ruri = ruri;
      counts.back().Add(row.Int(2), row.Int(1));
    }
    return counts;
  });
}

absl::StatusOr<std::vector<OpenRequestCount>> PostgresReader::OpenRequestCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Connection& connection) {
    Array robots{Type::kText};
    for (const std::string& ruri : ruris) robots.Text(ruri);
    return ReadAll(connection, StoreCallOf(kOpenRequestCounts, &robots), [](const ResultRow& row) {
      return OpenRequestCount{TextIn(row, 0), row.Int(1)};
    });
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
UPLINK_LIST(Audit, 15, AuditRow, AuditQuery, kAsAudit)
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
