#include "storage/sqlite/open_runs.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "storage/bounds.h"
#include "storage/rows.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {

absl::Status OpenRuns::Prepare(Database& database) {
  const auto close = [](RunClosed why) {
    return "UPDATE mission_runs SET is_open = 0, closed_why = " +
           std::to_string(static_cast<int>(why)) +
           ", closed_at = ?1 WHERE rowid IN (SELECT rowid FROM mission_runs WHERE ";
  };
  Preparer prepare(database);
  prepare.Into(count_, "SELECT COUNT(*) FROM mission_runs WHERE ruri = ? AND is_open");
  prepare.Into(close_over_, close(RunClosed::kForBound) +
                                "ruri = ?2 AND is_open"
                                " ORDER BY last_entry, last_at, entry LIMIT ?3)");
  // A run's last report is hardly ever older than its first one, by which the index goes.
  prepare.Into(close_old_, close(RunClosed::kForAge) +
                               "first_at < ?2 AND last_at < ?2 AND is_open"
                               " ORDER BY first_at, entry LIMIT ?3) RETURNING 1");
  return prepare.status();
}

absl::StatusOr<std::size_t> OpenRuns::CloseOver(std::string_view ruri, SystemTime at) {
  const absl::StatusOr<std::size_t> open = CountOf(*count_, ruri);
  if (!open.ok()) return open.status();
  if (*open <= kOpenRunsPerRobotMax) return 0;
  const std::size_t over = std::min(*open - kOpenRunsPerRobotMax, kSweepRowsMax);
  absl::Status closed = close_over_->Run(UnixMs(at), ruri, static_cast<std::int64_t>(over));
  if (!closed.ok()) return closed;
  return over;
}

absl::StatusOr<std::size_t> OpenRuns::CloseOld(SystemTime until, SystemTime at) {
  return CountReturned(
      close_old_->Select(UnixMs(at), UnixMs(until), static_cast<std::int64_t>(kSweepRowsMax)));
}

}  // namespace uplink::storage::sqlite
