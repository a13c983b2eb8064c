#include "storage/sqlite/reader.h"

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/json/text.h"
#include "storage/read_row.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/live_table.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/set_aside_tables.h"

namespace uplink::storage::sqlite {
namespace {

/// After the file could not be read, so many looks at its disk go by what it said before: each try
/// may take the whole wait for a lock, on the thread that answers operators.
constexpr int kLooksWithout = 30;

/// What `read` makes of each row of a statement that is prepared for this call alone.
template <typename Read, typename... Args>
auto ReadAll(Database& database, std::string_view sql, const Read& read, const Args&... args)
    -> decltype(std::declval<Rows&>().All(read)) {
  auto statement = database.Prepare(sql);
  if (!statement.ok()) return statement.status();
  return (*statement)->Select(args...).All(read);
}

}  // namespace

/// The connections of a reader that no read uses now. Thread-safe.
class SqliteReader::Pool final {
 public:
  Pool(std::string path, const ReaderOptions& options)
      : path_(std::move(path)), options_(options) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Opens them all; what fails names the path.
  [[nodiscard]] absl::Status Fill() {
    for (std::size_t i = 0; i < options_.connections; ++i) {
      auto database = OpenToRead(path_, options_.wait_max, options_.damage);
      if (!database.ok()) return database.status();
      free_.push_back(*std::move(database));
    }
    return absl::OkStatus();
  }

  /// Runs `read` with a connection; waits for one.
  template <typename Read>
  auto With(const Read& read) -> decltype(read(std::declval<Database&>())) {
    std::unique_ptr<Database> database;
    {
      std::unique_lock lock(mutex_);
      if (!returned_.wait_for(lock, options_.wait_max, [this] { return !free_.empty(); })) {
        return absl::UnavailableError("all reading connections of " + path_ + " are in use");
      }
      database = std::move(free_.back());
      free_.pop_back();
    }
    database->LimitSteps(options_.steps_max);
    auto result = read(*database);
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(database));
    returned_.notify_one();
    return result;
  }

 private:
  const std::string path_;
  const ReaderOptions options_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Database>> free_;
};

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
  constexpr std::string_view kSql =
      "SELECT r.ruri, r.fleet, r.first_seen, max(r.last_seen, coalesce(s.last_used, 0),"
      " coalesce(l.last_sign_at, 0), coalesce(c.last_used, 0)) AS heard_ms,"
      " p.presence, p.changed_at, p.parked_until, s.session,"
      " CASE WHEN l.session = s.session THEN"
      " max(s.cursor_seq, l.settled_seq) ELSE s.cursor_seq END, r.owner, c.ruri IS NOT NULL"
      " FROM robots AS r"
      " LEFT JOIN presence_latest AS p ON p.ruri = r.ruri"
      " LEFT JOIN sessions AS s ON s.ruri = r.ruri AND s.session = (SELECT session FROM sessions"
      " WHERE ruri = r.ruri ORDER BY last_used DESC, session DESC LIMIT 1)"
      " LEFT JOIN live AS l ON l.ruri = r.ruri"
      " LEFT JOIN drone_claims AS c ON c.ruri = r.ruri"
      " WHERE substr(r.ruri, 1, 10) <> 'cyberwave:'"
      " ORDER BY heard_ms DESC, r.ruri LIMIT ?";
  return pool_->With([&](Database& database) {
    return ReadAll(database, kSql, RobotIn<Rows>, std::int64_t{robots_max});
  });
}

absl::StatusOr<std::size_t> SqliteReader::RobotCount() {
  return pool_->With([](Database& database) -> absl::StatusOr<std::size_t> {
    const absl::StatusOr<std::int64_t> count =
        database.ReadInt("SELECT count(*) FROM robots WHERE substr(ruri, 1, 10) <> 'cyberwave:'");
    if (!count.ok()) return count.status();
    return static_cast<std::size_t>(*count);
  });
}

absl::StatusOr<std::vector<std::string>> SqliteReader::FleetsBeyondAscii(std::uint32_t fleets_max) {
  constexpr std::string_view kSql =
      "SELECT DISTINCT fleet FROM robots WHERE substr(ruri, 1, 10) <> 'cyberwave:'"
      " AND length(CAST(fleet AS BLOB)) > length(fleet) ORDER BY fleet LIMIT ?";
  return pool_->With([&](Database& database) {
    return ReadAll(
        database, kSql, [](const Rows& row) { return TextIn(row, 0); }, std::int64_t{fleets_max});
  });
}

absl::StatusOr<DiskSpace> SqliteReader::Space() {
  absl::StatusOr<DiskSpace> space = DiskSpaceOf(pool_->path());
  if (!space.ok()) return space;
  const Room& room = LookAtRoom();
  // What a WAL always has and is moved all the time would only make the figure go up and down.
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
  return pool_->With([&](Database& database) {
    return ReadAll(database,
                   "SELECT reason, count FROM quarantine_dropped WHERE ruri = ? ORDER BY reason",
                   DroppedIn<Rows>, ruri);
  });
}

absl::StatusOr<std::vector<StoredReject>> SqliteReader::Rejects(const RejectsQuery& query) {
  return pool_->With([&](Database& database) {
    return ReadAll(
        database, kRejectsSql, [](const Rows& row) { return RejectIn(row); }, query.ruri,
        query.session, query.above, query.through, query.rows_max);
  });
}

absl::StatusOr<std::vector<ActiveFaults>> SqliteReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<ActiveFaults>> {
    auto statement = database.Prepare(
        "SELECT ruri, severity FROM faults_active"
        " WHERE ruri IN (SELECT value FROM json_each(?)) ORDER BY ruri");
    if (!statement.ok()) return statement.status();
    // One run for all robots, not one for each: answers that filter by faults wait for it.
    const std::string list = json::ArrayText(ruris);
    std::vector<ActiveFaults> counts;
    absl::Status read = (*statement)->Select(list).ForEach([&counts](const Rows& row) {
      const std::string_view ruri = row.Bytes(0);
      if (counts.empty() || counts.back().ruri != ruri) {
        counts.push_back({.ruri = std::string(ruri)});
      }
      counts.back().Add(row.Int(1), 1);
    });
    if (!read.ok()) return read;
    return counts;
  });
}

absl::StatusOr<std::vector<OpenRequestCount>> SqliteReader::OpenRequestCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<OpenRequestCount>> {
    auto statement =
        database.Prepare("SELECT COUNT(*) FROM operator_requests WHERE ruri = ? AND is_open");
    if (!statement.ok()) return statement.status();
    std::vector<OpenRequestCount> counts;
    for (const std::string& ruri : ruris) {
      const absl::StatusOr<std::int64_t> count = (*statement)->Select(ruri).OnlyInt();
      if (!count.ok()) return count.status();
      if (*count > 0) counts.push_back({ruri, *count});
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
UPLINK_LIST(Audit, 15, AuditRow, AuditQuery, kAsAudit)
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
      absl::Status read =
          (*statement)->Select(ruri, std::int64_t{kinds}).ForEach([&](const Rows& row) {
            bytes += row.TextBytes();
            latest.rows.push_back(LatestIn(row, ruri));
          });
      if (!read.ok()) return read;
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
