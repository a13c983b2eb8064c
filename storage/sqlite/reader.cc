#include "storage/sqlite/reader.h"

#include <condition_variable>
#include <mutex>
#include <utility>

#include "storage/sqlite/database.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/schema.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {
namespace {

constexpr ListShape kFaultHistory = {
    PageKind::kFaultHistory, "faults_history",
    "received_ms, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, active",
    "received_ms"};
constexpr ListShape kFaultsActive = {
    PageKind::kFaultsActive, "faults_active",
    "received_ms, sampled_ms, fault_id, source, severity, category, description,"
    " suggested_action, 1",
    "raised_ms"};
constexpr ListShape kQuarantine = {PageKind::kQuarantine, "quarantine",
                                   "session, seq, reason, field, detail, payload_bytes, payload",
                                   "received_ms"};
constexpr ListShape kGaps = {PageKind::kGaps, "gaps", "session, first, last", "seen_ms"};

std::string Text(const Rows& rows, int column) { return std::string(rows.Bytes(column)); }

model::RobotId RobotOf(const Rows& rows) {
  return {Text(rows, kRuriColumn), Text(rows, kFleetColumn)};
}

absl::StatusOr<model::SessionId> SessionOf(const Rows& rows) {
  const auto session = model::SessionId::FromBytes(rows.Bytes(kFirstOwnColumn));
  if (!session) return absl::InternalError("a session in the store is not 16 bytes");
  return *session;
}

absl::StatusOr<FaultRow> ReadFault(const Rows& rows) {
  int column = kFirstOwnColumn;
  FaultRow row;
  row.robot = RobotOf(rows);
  row.received_at = FromUnixMs(rows.Int(column++));
  row.fault.unix_time_ms = rows.Int(column++);
  row.fault.fault_id = Text(rows, column++);
  row.fault.source = Text(rows, column++);
  row.fault.severity =
      static_cast<model::FaultSeverity>(static_cast<std::uint16_t>(rows.Int(column++)));
  row.fault.category = Text(rows, column++);
  row.fault.description = Text(rows, column++);
  row.fault.suggested_action = Text(rows, column++);
  row.fault.active = rows.Int(column) != 0;
  return row;
}

absl::StatusOr<FaultRow> ReadActiveFault(const Rows& rows) {
  absl::StatusOr<FaultRow> row = ReadFault(rows);
  if (row.ok()) row->raised_at = FromUnixMs(rows.Int(kTimeColumn));
  return row;
}

absl::StatusOr<QuarantineRow> ReadQuarantine(const Rows& rows) {
  const absl::StatusOr<model::SessionId> session = SessionOf(rows);
  if (!session.ok()) return session.status();
  int column = kFirstOwnColumn + 1;
  QuarantineRow row;
  row.robot = RobotOf(rows);
  row.session = *session;
  row.received_at = FromUnixMs(rows.Int(kTimeColumn));
  row.seq = static_cast<model::Seq>(rows.Int(column++));
  row.rejection.reason = ReasonOf(rows.Int(column++));
  row.rejection.field = Text(rows, column++);
  row.rejection.detail = Text(rows, column++);
  row.payload_bytes = static_cast<std::uint64_t>(rows.Int(column++));
  row.payload = Text(rows, column);
  return row;
}

absl::StatusOr<GapRow> ReadGap(const Rows& rows) {
  const absl::StatusOr<model::SessionId> session = SessionOf(rows);
  if (!session.ok()) return session.status();
  int column = kFirstOwnColumn + 1;
  GapRow row;
  row.robot = RobotOf(rows);
  row.session = *session;
  row.seen_at = FromUnixMs(rows.Int(kTimeColumn));
  row.first = static_cast<model::Seq>(rows.Int(column++));
  row.last = static_cast<model::Seq>(rows.Int(column));
  return row;
}

}  // namespace

/// The connections that no read uses now. Thread-safe.
class SqliteReader::Pool final {
 public:
  Pool(std::string path, const ReaderOptions& options)
      : path_(std::move(path)), options_(options) {}

  absl::Status Fill() {
    for (std::size_t i = 0; i < options_.connections; ++i) {
      auto database = Database::Open(path_, Access::kRead, options_.wait_max);
      if (!database.ok()) return database.status();
      absl::Status status = CheckFile(**database, Migrations());
      // Reads the schema; refuses what is older, since a reader cannot migrate.
      if (status.ok()) status = Migrate(**database, Migrations(), IfOlder::kRefuse);
      if (!status.ok()) return status;
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
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<RobotRow>> {
    // Commits touch a robot's sessions, not its own row.
    auto statement = database.Prepare(
        "SELECT ruri, fleet, first_seen_ms, max(last_seen_ms, coalesce((SELECT"
        " max(last_used_ms) FROM sessions WHERE sessions.ruri = robots.ruri), 0))"
        " FROM robots ORDER BY ruri LIMIT ?");
    if (!statement.ok()) return statement.status();
    Rows rows = (*statement)->Select(std::int64_t{robots_max});
    std::vector<RobotRow> robots;
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) return robots;
      robots.push_back(
          {{Text(rows, 0), Text(rows, 1)}, FromUnixMs(rows.Int(2)), FromUnixMs(rows.Int(3))});
    }
  });
}

absl::StatusOr<Page<FaultRow>> SqliteReader::FaultsActive(const HistoryQuery& query) {
  return pool_->With([&](Database& database) {
    return ReadPage<FaultRow>(database, kFaultsActive, query, ReadActiveFault);
  });
}

absl::StatusOr<Page<FaultRow>> SqliteReader::FaultHistory(const HistoryQuery& query) {
  return pool_->With([&](Database& database) {
    return ReadPage<FaultRow>(database, kFaultHistory, query, ReadFault);
  });
}

absl::StatusOr<std::vector<ActiveFaults>> SqliteReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return pool_->With([&](Database& database) -> absl::StatusOr<std::vector<ActiveFaults>> {
    auto statement = database.Prepare("SELECT COUNT(*) FROM faults_active WHERE ruri = ?");
    if (!statement.ok()) return statement.status();
    std::vector<ActiveFaults> counts;
    for (const std::string& ruri : ruris) {
      Rows rows = (*statement)->Select(std::string_view(ruri));
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (*found && rows.Int(0) > 0) counts.push_back({ruri, rows.Int(0)});
    }
    return counts;
  });
}

absl::StatusOr<Page<QuarantineRow>> SqliteReader::Quarantine(const HistoryQuery& query) {
  return pool_->With([&](Database& database) {
    return ReadPage<QuarantineRow>(database, kQuarantine, query, ReadQuarantine);
  });
}

absl::StatusOr<Page<GapRow>> SqliteReader::Gaps(const HistoryQuery& query) {
  return pool_->With(
      [&](Database& database) { return ReadPage<GapRow>(database, kGaps, query, ReadGap); });
}

}  // namespace uplink::storage::sqlite
