#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Closes mission runs that their robots leave open: past the bound, or past their age.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class OpenRuns final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Closes the robot's open runs over kOpenRunsPerRobotMax, those that were reported least
  /// recently first, at most kSweepRowsMax. Returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> CloseOver(std::string_view ruri, SystemTime at);
  /// Closes runs that were not reported since `until`, at most kSweepRowsMax. Returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> CloseOld(SystemTime until, SystemTime at);

 private:
  std::unique_ptr<Statement> count_, close_over_, close_old_;
};

}  // namespace uplink::storage::sqlite
