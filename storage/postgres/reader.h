#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/disk_space.h"
#include "storage/postgres/defaults.h"
#include "storage/postgres/horizon.h"
#include "storage/reader.h"

namespace uplink::storage::postgres {

struct ReaderOptions {
  /// As StoreOptions.
  std::string url;
  std::string password_file;
  /// Reads that run at once; more wait for their turn.
  std::size_t connections = kReadersDefault;
  /// How long a read waits for its turn.
  milliseconds wait_max{2'000};
  milliseconds connect_timeout{2'000};
  /// How long one statement may take: the server ends it then.
  milliseconds statement_timeout{5'000};
  /// After a failed connect, reads fail at once for this long.
  milliseconds retry_pause{1'000};
};

/// The query side of a PostgreSQL store: a small pool of read-only connections, apart from the
/// writers', made when they are needed. A read sees what was committed before it began and locks
/// nothing that a commit wants.
///
/// Errors:  as in Reader; kDeadlineExceeded past statement_timeout, kUnavailable while the server
///          is away or if no connection came free in time.
/// Thread:  thread-safe.
class PostgresReader final : public Reader {
 public:
  /// Connects to nothing yet. `clock` must outlive the reader.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresReader>> Open(
      const ReaderOptions& options, const Clock& clock);
  ~PostgresReader() override;
  PostgresReader(const PostgresReader&) = delete;
  PostgresReader& operator=(const PostgresReader&) = delete;

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

  /// How long something in the database has kept dead row versions from being removed; counts from
  /// the first call that saw it (HorizonAge). One call at a time.
  [[nodiscard]] absl::StatusOr<milliseconds> OldestSnapshot();
  /// What is left where the database lies; nothing where that cannot be known (ReadDataFolder),
  /// which is asked now and then. The server's log of writes (pg_wal) may lie elsewhere. One call
  /// at a time.
  ///
  /// Errors: kUnavailable where the disk cannot be asked.
  [[nodiscard]] absl::StatusOr<std::optional<DiskSpace>> Space();

 private:
  class Pool;
  explicit PostgresReader(std::unique_ptr<Pool> pool);
  std::unique_ptr<Pool> pool_;
  HorizonAge horizon_age_;
  std::optional<SteadyTime> folder_asked_;
  std::string folder_;
};

}  // namespace uplink::storage::postgres
