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

/// How often the store is asked for robots that an operator wants to be forgotten. Two looks and
/// what lies between them, of a robot that has nothing to wait for, take less than a second.
inline constexpr milliseconds kLookForForgottenEvery{400};
/// The same while a robot is about to leave memory: an operator waits for it.
inline constexpr milliseconds kLookAtLeavingEvery{50};
/// The same after the store did not answer.
inline constexpr milliseconds kLookAgainEvery{2'500};

/// Lets robots go that an operator wants to be forgotten, answers that they are let go, or why not,
/// and follows where another process or nobody held them. Drives SilentRows besides.
///
/// Errors:  of the store: the log says when it begins to fail and when it works again, and a later
///          round tries again.
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
    /// The store is this process's alone.
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

  /// All requests. kUnderWay: one of them is to be looked at again soon.
  absl::StatusOr<Look> LookAtAll();
  absl::StatusOr<Look> LookAt(const storage::PendingForget& asked);
  absl::StatusOr<Look> LetGo(const storage::PendingForget& asked, robot::Robot& robot);
  absl::StatusOr<Look> Tell(const storage::PendingForget& asked, storage::ForgetAnswer answer);
  /// The robot's row is gone, and it has no stream here.
  Look Follow(const storage::PendingForget& asked);
  /// Its row was removed while a stream of it is here, which this process could not tell in time:
  /// the stream ends, and its next one makes a row.
  void OpenAnew(robot::Robot& robot);
  void Leave(robot::Robot& robot);
  /// Logs when the store begins to fail, and when it works again.
  void NoteOutcome(const absl::Status& status);

  const Context context_;
  SilentRows silent_rows_;
  /// Finished requests that were a line of the log; those of before the start are none.
  std::set<std::uint64_t> told_;
  bool first_look_ = true;
  bool failing_ = false;
  loop::Rounds rounds_;
};

}  // namespace uplink::store
