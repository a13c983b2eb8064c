#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/log/logger.h"
#include "server/store/vouched_clock.h"
#include "storage/robot_removal.h"

namespace uplink::store {

/// How often to search for rows of robots that were silent for longer than anything is kept.
inline constexpr std::chrono::hours kRemoveSilentEvery{1};
/// The same after the store failed.
inline constexpr std::chrono::minutes kRemoveSilentAgainAfter{1};

/// How long a robot keeps its rows. A value.
struct RowsRule {
  milliseconds forget_after{0};
  milliseconds retain_history{0};
  milliseconds retain_quarantine{0};
  milliseconds retain_connections{0};

  /// Robots that were last heard before this time have no row any more. Empty if they keep it for
  /// ever: if any of these is zero.
  [[nodiscard]] std::optional<SystemTime> Until(SystemTime now) const;
};

[[nodiscard]] RowsRule RowsRuleOf(const config::Config& config);

/// Removes the rows of robots that were silent for longer than histories are kept, and that are not
/// in this server's memory.
///
/// Errors:  of the store; it goes on where it stopped after kRemoveSilentAgainAfter.
/// Thread:  confined to one thread at a time.
class SilentRows final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const Clock& clock;
    const log::Logger& logger;
    storage::RobotRemoval& removal;
    /// This process.
    storage::ProcessId process{};
    RowsRule rule;
    /// While civil time is not vouched for, no robot counts as silent.
    const VouchedClock& trust;
  };
  explicit SilentRows(Context context) : context_(std::move(context)) {}

  /// If a look is due, reads one answer of the store and removes the robots in it. Further calls
  /// take the next ones, until all were looked at. Returns the result of the last look.
  absl::Status Round();

 private:
  enum class Left { kNothing, kMore };

  absl::StatusOr<Left> RemoveSome(SystemTime until);

  const Context context_;
  std::optional<SteadyTime> due_;
  /// The RURI that was last looked at; empty at the beginning.
  std::string after_;
  absl::Status outcome_;
};

}  // namespace uplink::store
