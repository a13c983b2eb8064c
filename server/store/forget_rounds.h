#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/store/vouched_clock.h"
#include "storage/robot_removal.h"

namespace uplink::store {

/// How often the store is asked for robots that an operator wants to be forgotten: twice, so that
/// it is done within a second.
inline constexpr milliseconds kLookForForgottenEvery{400};
/// The same while one is on its way out.
inline constexpr milliseconds kLookAtLeavingEvery{50};
/// The same while the store does not answer.
inline constexpr milliseconds kLookAgainEvery{2'500};
/// How often rows are looked for of robots that were silent for longer than anything is kept.
inline constexpr std::chrono::hours kRemoveSilentEvery{1};

/// How long a robot keeps its rows. A value.
struct RowsRule {
  milliseconds forget_after{0};
  milliseconds retain_history{0};
  milliseconds retain_quarantine{0};

  /// Robots of which nothing was heard since then have no row any more. Nothing if they keep it:
  /// while any of these is zero, for ever.
  [[nodiscard]] std::optional<SystemTime> Until(SystemTime now) const;
};

[[nodiscard]] RowsRule RowsRuleOf(const config::Config& config);

/// Lets robots go that an operator wants to be forgotten, answers that they are let go, or why not,
/// and follows where another process or nobody held them. Removes the rows of robots that were
/// silent for longer than histories are kept, and that are in no memory.
///
/// Errors:  of the store: the next round tries again.
/// Thread:  constructed, started and stopped by main; Round by a thread of its own.
class ForgetRounds final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    const Clock& clock;
    const log::Logger& logger;
    storage::RobotRemoval& removal;
    /// This process.
    storage::ProcessId process{};
    RowsRule rows;
    /// While nobody vouches for civil time, nobody was silent for long.
    const VouchedClock& trust;
  };
  explicit ForgetRounds(Context context) : context_(std::move(context)) {}
  ~ForgetRounds() { Stop(); }
  ForgetRounds(const ForgetRounds&) = delete;
  ForgetRounds& operator=(const ForgetRounds&) = delete;

  /// One look. Returns when the next is due.
  milliseconds Round();
  void Start();
  /// Idempotent.
  void Stop();

 private:
  enum class Look : std::uint8_t { kDone, kUnderWay };

  Look LookAt(const storage::PendingForget& asked);
  Look LetGo(const storage::PendingForget& asked, robot::Robot& robot);
  Look Tell(const storage::PendingForget& asked, storage::ForgetAnswer answer);
  /// The robot's row is gone, and it has no stream here.
  Look Follow(const storage::PendingForget& asked);
  void Leave(robot::Robot& robot);
  void RemoveSilent();
  void Run(const std::stop_token& stop);

  const Context context_;
  std::optional<SteadyTime> removed_silent_;
  std::mutex mutex_;
  std::condition_variable_any pause_;
  std::jthread thread_;
};

}  // namespace uplink::store
