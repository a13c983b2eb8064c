#pragma once

#include <atomic>
#include <functional>
#include <semaphore>
#include <utility>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace uplink::run {

/// SIGTERM and SIGINT: the first asks the server to stop, the second ends the process at once,
/// with 1. While the server starts, the first ends it at once, with 0: a drain would have nothing
/// to settle. "At once" is after log::kFlushWait if nothing reads the log.
///
/// Thread: OnSignal and OnFailure on one thread (the loop's); the rest on another (main).
class StopSignal final {
 public:
  /// `tell_stopped` says, on the loop's thread, that the signal of that number ends the start.
  StopSignal(const log::Logger& logger, std::function<void(int)> tell_stopped)
      : logger_(logger), tell_stopped_(std::move(tell_stopped)) {}
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The server has started: from now on the first signal wakes Wait.
  void NoteStarted() { started_.store(true); }
  /// The signal came, for the first or the second time.
  void OnSignal(int signal);
  /// The server cannot go on: it stops as by the first signal, and the process ends with 1.
  void OnFailure();
  /// Waits for the first signal.
  void Wait() { stop_.acquire(); }
  /// After Wait: what the process ends with once it has stopped.
  [[nodiscard]] int exit_code() const { return failed_.load() ? 1 : 0; }
  /// After Wait: a pause between two looks. No signal ends it early, since a second one ends the
  /// process.
  void Pause(milliseconds wait) { static_cast<void>(stop_.try_acquire_for(wait)); }

 private:
  const log::Logger& logger_;
  const std::function<void(int)> tell_stopped_;
  std::atomic<bool> started_{false};
  std::atomic<bool> failed_{false};
  bool stopping_ = false;
  std::binary_semaphore stop_{0};
};

}  // namespace uplink::run
