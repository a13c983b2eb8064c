#pragma once

#include <atomic>
#include <semaphore>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace uplink::run {

/// SIGTERM and SIGINT: the first asks the server to stop, the second ends the process at once (or
/// after log::kFlushWait, if nothing reads the log).
/// While the server starts the first does that, with 0: nothing is under way that a drain would
/// settle.
///
/// Thread: OnSignal and OnFailure on one thread (the loop's); the rest on another (main).
class StopSignal final {
 public:
  explicit StopSignal(const log::Logger& logger) : logger_(logger) {}
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The server has started: from now on somebody waits.
  void NoteStarted() { started_.store(true); }
  /// The signal came. The second time the process ends with 1.
  void OnSignal(int signal);
  /// The server cannot go on: it stops as by the first signal, and the process ends with 1.
  void OnFailure();
  /// Waits for the first signal.
  void Wait() { stop_.acquire(); }
  /// After Wait: what the process ends with once it has stopped.
  [[nodiscard]] int exit_code() const { return failed_.load() ? 1 : 0; }
  /// After Wait: a pause between two looks. Nothing ends it early, since a second signal ends the
  /// process.
  void Pause(milliseconds wait) { static_cast<void>(stop_.try_acquire_for(wait)); }

 private:
  const log::Logger& logger_;
  std::atomic<bool> started_{false};
  std::atomic<bool> failed_{false};
  bool stopping_ = false;
  std::binary_semaphore stop_{0};
};

}  // namespace uplink::run
