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

namespace uplink::storage::sqlite {

struct ReaderOptions {
  /// Reads that run at once; more wait for their turn.
  std::size_t connections = 2;
  /// How long a read waits for its turn, and for a lock of the file.
  milliseconds wait_max{2'000};
  /// Steps of SQLite's machine that one call may take: some 100 million a second.
  std::int64_t steps_max = 200'000'000;
  /// Told of what the reads find damaged.
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
  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained) \
  [[nodiscard]] absl::StatusOr<Page<Row>> Name(const Query& query) override;
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  [[nodiscard]] absl::StatusOr<std::vector<DroppedRow>> QuarantineDropped(
      const std::string& ruri) override;
  [[nodiscard]] absl::StatusOr<std::vector<StoredReject>> Rejects(
      const RejectsQuery& query) override;
  [[nodiscard]] absl::StatusOr<std::vector<ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  [[nodiscard]] absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                  LatestKindSet kinds) override;
  [[nodiscard]] absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) override;

  /// What is left on the file's disk, and in the file itself: pages of rows that were deleted are
  /// written again, and never given back to the disk.
  ///
  /// Errors: as of a call; kUnavailable also where the disk cannot be asked.
  [[nodiscard]] absl::StatusOr<DiskSpace> Space();

 private:
  class Pool;
  explicit SqliteReader(std::unique_ptr<Pool> pool);
  /// Of the file's free pages.
  [[nodiscard]] std::uint64_t ReusableBytes();

  std::unique_ptr<Pool> pool_;
  /// As of the last look that could ask, and how many looks more do not ask.
  std::uint64_t reusable_bytes_ = 0;
  int looks_without_ = 0;
};

}  // namespace uplink::storage::sqlite
