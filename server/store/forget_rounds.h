#pragma once

#include <chrono>
#include <cstdint>
#include <set>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "server/store/silent_rows.h"
#include "server/store/vouched_clock.h"
#include "storage/forget_store.h"

namespace uplink::store {

/// How often the store is asked for robots that an operator wants to forget. Two looks and the work
/// between them take under a second, if the robot has nothing to wait for.
inline constexpr milliseconds kLookForForgottenEvery{400};
/// The same while a robot is about to leave memory: an operator waits for it.
inline constexpr milliseconds kLookAtLeavingEvery{50};
/// The same after the store did not answer.
inline constexpr milliseconds kLookAgainEvery{2'500};

/// Lets go of robots that an operator wants to forget, answers that it did or why not, and follows
/// requests for robots that another process or none held. It also drives SilentRows.
///
/// Errors:  of the store: logged when it begins to fail and when it works again; a later round
///          tries again.
/// Thread:  constructed, started and stopped by main; Round by a thread of its own.
class ForgetRounds final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    const Clock& clock;
    const log::Logger& logger;
    storage::ForgetStore& store;
    /// This process.
    storage::ProcessId process{};
    /// This process has the store alone.
    bool alone = false;
    /// Of SilentRows.
    RowsRule rows;
    const VouchedClock& trust;
  };
  explicit ForgetRounds(Context context);
  ForgetRounds(const ForgetRounds&) = delete;
  ForgetRounds& operator=(const ForgetRounds&) = delete;

  /// One look. Returns when the next is due.
  milliseconds Round();
  void Start() { rounds_.Start(); }
  /// Idempotent.
  void Stop() { rounds_.Stop(); }

 private:
  enum class Look : std::uint8_t { kDone, kUnderWay };

  /// Looks at all requests. kUnderWay: look at one of them again soon.
  absl::StatusOr<Look> LookAtAll();
  absl::StatusOr<Look> LookAt(const storage::PendingForget& asked);
  absl::StatusOr<Look> LetGo(const storage::PendingForget& asked, robot::Robot& robot);
  absl::StatusOr<Look> Tell(const storage::PendingForget& asked, storage::ForgetAnswer answer);
  /// The robot's row is gone, and it has no stream here.
  Look Follow(const storage::PendingForget& asked);
  /// Its row was removed while a stream of it is here, which this process could not report in time.
  /// Ends the stream; the next one makes a row.
  void OpenAnew(robot::Robot& robot);
  void Leave(robot::Robot& robot);
  /// Logs when the store begins to fail, and when it works again.
  void NoteOutcome(const absl::Status& status);

  const Context context_;
  SilentRows silent_rows_;
  /// Finished requests that were logged; those before the start are not.
  std::set<std::uint64_t> told_;
  bool first_look_ = true;
  bool failing_ = false;
  loop::Rounds rounds_;
};

}  // namespace uplink::store
