#include "storage/sqlite/reader.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "storage/numbers.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/lists.h"
#include "storage/sqlite/live_table.h"
#include "storage/sqlite/reader_pool.h"
#include "storage/sqlite/set_aside_tables.h"

namespace uplink::storage::sqlite {
namespace {

/// After the file could not be read, so many looks at its disk go by what it said before: each try
/// may take the whole wait for a lock, on the thread that answers operators.
constexpr int kLooksWithout = 30;

RobotRow RobotOf(const Rows& rows) {
  RobotRow robot{.robot = {std::string(rows.Bytes(0)), std::string(rows.Bytes(1))},
                 .first_seen = FromUnixMs(rows.Int(2)),
                 .last_seen = FromUnixMs(rows.Int(3))};
  if (!rows.Null(4)) {
    robot.last_presence = PresenceOf(rows.Int(4));
    robot.presence_since = FromUnixMs(rows.Int(5));
  }
  if (const auto session = model::SessionId::FromBytes(rows.Bytes(6))) {
    robot.last_session = {*session, static_cast<model::Seq>(rows.Int(7))};
  }
  if (const auto holder = model::SessionId::FromBytes(rows.Bytes(8))) {
    robot.holder = holder->bytes();
  }
  return robot;
}

}  // namespace

SqliteReader::SqliteReader(std::unique_ptr<Pool> pool) : pool_(std::move(pool)) {}
SqliteReader::~SqliteReader() = default;

absl::StatusOr<std::unique_ptr<SqliteReader>> SqliteReader::Open(const std::string& path,
                                                                 const ReaderOptions& options) {
  auto pool = std::make_unique<Pool>(path, options);
  absl::Status filled = pool->Fill();
  if (!filled.ok()) return filled;
  return std::unique_ptr<SqliteReader>(new SqliteReader(std::move(pool)));
}

absl::StatusOr<std::vector<RobotRow>> SqliteReader::Robots(std::uint32_t robots_max) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<RobotRow>> {
    // Commits touch a robot's sessions, not its own row.
    auto statement = database.Prepare(
        "SELECT r.ruri, r.fleet, r.first_seen, max(r.last_seen, coalesce(s.last_used, 0),"
        " coalesce(l.last_sign_at, 0)) AS heard_ms,"
        " p.presence, p.changed_at, s.session, CASE WHEN l.session = s.session THEN"
        " max(s.cursor_seq, l.settled_seq) ELSE s.cursor_seq END, r.owner FROM robots AS r"
        " LEFT JOIN presence_latest AS p ON p.ruri = r.ruri"
        " LEFT JOIN sessions AS s ON s.ruri = r.ruri AND s.session = (SELECT session FROM sessions"
        " WHERE ruri = r.ruri ORDER BY last_used DESC, session DESC LIMIT 1)"
        " LEFT JOIN live AS l ON l.ruri = r.ruri"
        // Those that stand for no robot (origin.h).
        " WHERE substr(r.ruri, 1, 10) <> 'cyberwave:'"
        " ORDER BY heard_ms DESC, r.ruri LIMIT ?");
    if (!statement.ok()) return statement.status();
    Rows rows = (*statement)->Select(std::int64_t{robots_max});
    std::vector<RobotRow> robots;
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) return robots;
      robots.push_back(RobotOf(rows));
    }
  });
}

absl::StatusOr<std::size_t> SqliteReader::RobotCount() {
  return pool_->With([](Database& database) -> absl::StatusOr<std::size_t> {
    auto statement =
        database.Prepare("SELECT count(*) FROM robots WHERE substr(ruri, 1, 10) <> 'cyberwave:'");
    if (!statement.ok()) return statement.status();
    Rows rows = (*statement)->Select();
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    return static_cast<std::size_t>(rows.Int(0));
  });
}

absl::StatusOr<std::vector<std::string>> SqliteReader::FleetsBeyondAscii(std::uint32_t fleets_max) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<std::string>> {
    auto statement = database.Prepare(
        "SELECT DISTINCT fleet FROM robots WHERE substr(ruri, 1, 10) <> 'cyberwave:'"
        // More bytes than characters.
        " AND length(CAST(fleet AS BLOB)) > length(fleet) ORDER BY fleet LIMIT ?");
    if (!statement.ok()) return statement.status();
    Rows rows = (*statement)->Select(std::int64_t{fleets_max});
    std::vector<std::string> fleets;
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) return fleets;
      fleets.emplace_back(rows.Bytes(0));
    }
  });
}

absl::StatusOr<DiskSpace> SqliteReader::Space() {
  absl::StatusOr<DiskSpace> space = DiskSpaceOf(pool_->path());
  if (!space.ok()) return space;
  const Room& room = LookAtRoom();
  // What a WAL always has and is moved all the time would only make the figure go to and fro.
  const WalState& wal = room.wal;
  const std::uint64_t released = wal.reusable_bytes - std::min(wal.reusable_bytes, kWalLargeBytes);
  const std::uint64_t has = space->free_bytes + room.free_pages_bytes + released;
  space->free_bytes = has - std::min(has, wal.held() ? wal.owed_bytes : 0);
  space->wal_bytes = wal.bytes;
  return space;
}

const SqliteReader::Room& SqliteReader::LookAtRoom() {
  if (looks_without_ > 0) {
    --looks_without_;
    return room_;
  }
  const auto seen = pool_->With([this](Database& database) -> absl::StatusOr<Room> {
    const absl::StatusOr<std::int64_t> free_pages = database.ReadInt(
        "SELECT freelist_count * page_size FROM pragma_freelist_count, pragma_page_size");
    if (!free_pages.ok()) return free_pages.status();
    const absl::StatusOr<std::optional<WalState>> wal = ReadWalState(database);
    if (!wal.ok()) return wal.status();
    return Room{static_cast<std::uint64_t>(*free_pages), wal->value_or(room_.wal)};
  });
  if (seen.ok()) {
    room_ = *seen;
  } else {
    looks_without_ = kLooksWithout;
  }
  return room_;
}

absl::StatusOr<milliseconds> SqliteReader::OldestSnapshot(SteadyTime now) {
  const auto wal = pool_->With([](Database& database) -> absl::StatusOr<std::optional<WalState>> {
    // A connection sees the files of others once it has read.
    const absl::StatusOr<std::int64_t> read = database.ReadInt("PRAGMA freelist_count");
    if (!read.ok()) return read.status();
    return ReadWalState(database);
  });
  if (!wal.ok()) return wal.status();
  // While somebody writes the index the next call looks again.
  if (!*wal) return absl::UnavailableError("the index of the WAL of " + pool_->path() + " changes");
  return hold_age_.Note(**wal, now);
}

absl::StatusOr<std::vector<DroppedRow>> SqliteReader::QuarantineDropped(const std::string& ruri) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<DroppedRow>> {
    auto statement = database.Prepare(
        "SELECT reason, count FROM quarantine_dropped WHERE ruri = ? ORDER BY reason");
    if (!statement.ok()) return statement.status();
    Rows rows = (*statement)->Select(std::string_view(ruri));
    std::vector<DroppedRow> dropped;
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) return dropped;
      dropped.push_back({ReasonOf(rows.Int(0)), static_cast<std::uint64_t>(rows.Int(1))});
    }
  });
}

absl::StatusOr<std::vector<StoredReject>> SqliteReader::Rejects(const RejectsQuery& query) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<StoredReject>> {
    auto statement = database.Prepare(kRejectsSql);
    if (!statement.ok()) return statement.status();
    return ReadRejects((*statement)
                           ->Select(std::string_view(query.ruri), Blob{query.session.AsBytes()},
                                    query.above, query.through,
                                    static_cast<std::int64_t>(query.rows_max)));
  });
}

absl::StatusOr<std::vector<ActiveFaults>> SqliteReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<ActiveFaults>> {
    auto statement = database.Prepare(
        "SELECT severity, COUNT(*) FROM faults_active WHERE ruri = ? GROUP BY severity");
    if (!statement.ok()) return statement.status();
    std::vector<ActiveFaults> counts;
    for (const std::string& ruri : ruris) {
      Rows rows = (*statement)->Select(std::string_view(ruri));
      ActiveFaults faults{.ruri = ruri};
      while (true) {
        const absl::StatusOr<bool> found = rows.Next();
        if (!found.ok()) return found.status();
        if (!*found) break;
        faults.Add(rows.Int(0), rows.Int(1));
      }
      if (faults.count > 0) counts.push_back(std::move(faults));
    }
    return counts;
  });
}

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                         \
  absl::StatusOr<Page<Row>> SqliteReader::Name(const Query& query) {                            \
    return pool_->With(                                                                         \
        [&query](Database& database) { return ReadList<PageKind::k##Name>(database, query); }); \
  }
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
// NOLINTEND(bugprone-macro-parentheses)

absl::StatusOr<Reader::LatestRows> SqliteReader::Latest(std::span<const std::string> ruris,
                                                        LatestKindSet kinds) {
  return pool_->With([&](Database& database) -> absl::StatusOr<LatestRows> {
    auto statement = database.Prepare(
        "SELECT kind, received_at, body FROM latest WHERE ruri = ? AND (? >> kind) & 1"
        " ORDER BY kind");
    if (!statement.ok()) return statement.status();
    LatestRows latest;
    std::size_t bytes = 0;
    for (const std::string& ruri : ruris) {
      Rows rows = (*statement)->Select(std::string_view(ruri), std::int64_t{kinds});
      while (true) {
        const absl::StatusOr<bool> found = rows.Next();
        if (!found.ok()) return found.status();
        if (!*found) break;
        bytes += rows.TextBytes();
        latest.rows.push_back({ruri, static_cast<LatestKind>(rows.Int(0)),
                               std::string(rows.Bytes(2)), FromUnixMs(rows.Int(1))});
      }
      ++latest.complete;
      if (bytes >= kPageBytesMax) break;
    }
    return latest;
  });
}

absl::StatusOr<Reader::LiveRows> SqliteReader::LiveOf(std::span<const std::string> ruris) {
  return pool_->With([&](Database& database) { return ReadLiveOf(database, ruris); });
}

}  // namespace uplink::storage::sqlite
