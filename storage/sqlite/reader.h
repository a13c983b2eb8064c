#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/disk_space.h"
#include "storage/reader.h"
#include "storage/sqlite/damage.h"
#include "storage/sqlite/wal.h"

namespace uplink::storage::sqlite {

struct ReaderOptions {
  /// Reads that run at once; more wait for their turn.
  std::size_t connections = 2;
  /// How long a read waits for its turn, and for a lock of the file.
  milliseconds wait_max{2'000};
  /// Steps of SQLite's machine that one call may take: some 100 million a second.
  std::int64_t steps_max = 200'000'000;
  /// Receives the damage that reads find.
  DamagePtr damage;
};

/// The query side of an SQLite store: connections of its own, read-only, beside the writer's. In
/// WAL mode a read sees the last commit before it began and holds up none.
///
/// Errors:  of Open, kFailedPrecondition, naming the path: no file, not ours, not this program's
///          schema version. Of the calls, as in Reader; kDeadlineExceeded past steps_max,
///          kUnavailable if no connection came free in time.
/// Thread:  thread-safe.
class SqliteReader final : public Reader {
 public:
  /// The file must be there and migrated: open the SqliteStore first.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteReader>> Open(
      const std::string& path, const ReaderOptions& options = {});
  ~SqliteReader() override;
  SqliteReader(const SqliteReader&) = delete;
  SqliteReader& operator=(const SqliteReader&) = delete;

  [[nodiscard]] absl::StatusOr<std::vector<RobotRow>> Robots(std::uint32_t robots_max) override;
  [[nodiscard]] absl::StatusOr<std::size_t> RobotCount() override;
  [[nodiscard]] absl::StatusOr<std::vector<std::string>> FleetsBeyondAscii(
      std::uint32_t fleets_max) override;
  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained) \
  [[nodiscard]] absl::StatusOr<Page<Row>> Name(const Query& query) override;
  UPLINK_LISTS(UPLINK_LIST)
  UPLINK_LIST(Audit, 15, AuditRow, AuditQuery, kAsAudit)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  [[nodiscard]] absl::StatusOr<std::vector<DroppedRow>> QuarantineDropped(
      const std::string& ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<StoredReject>> Rejects(
      const RejectsQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<std::vector<OpenRequestCount>> OpenRequestCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                  LatestKindSet kinds) override;
  [[nodiscard]] absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) override;

  /// What is left on the file's disk and in the files themselves: pages of rows that were deleted
  /// are written again, and so is a large WAL that was moved into the database. While one is held,
  /// what moving it will take is not free. One call at a time.
  ///
  /// Errors: as of a call; kUnavailable also where the disk cannot be asked.
  [[nodiscard]] absl::StatusOr<DiskSpace> Space();
  /// How long another connection has kept the WAL from being moved into the database; counts from
  /// the first call that saw it. One call at a time.
  [[nodiscard]] absl::StatusOr<milliseconds> OldestSnapshot(SteadyTime now);

 private:
  class Pool;
  explicit SqliteReader(std::unique_ptr<Pool> pool);
  /// Of the files: what is free in them, and how the WAL stands.
  struct Room {
    std::uint64_t free_pages_bytes = 0;
    WalState wal;
  };
  /// As of the last look that could ask.
  [[nodiscard]] const Room& LookAtRoom();

  std::unique_ptr<Pool> pool_;
  Room room_;
  /// How many looks more do not ask.
  int looks_without_ = 0;
  WalHoldAge hold_age_;
};

}  // namespace uplink::storage::sqlite
