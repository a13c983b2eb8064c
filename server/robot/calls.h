#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>

#include "schema/base/clock.h"
#include "server/robot/commit_client.h"

namespace uplink::robot {

/// The live data of a robot's calls, which counts in the budget of live state. Thread-safe.
class CallsLive {
 public:
  virtual ~CallsLive() = default;
  [[nodiscard]] virtual std::size_t live_bytes() const = 0;
  /// Drops all of it; later messages are held again. Returns the bytes that it freed.
  virtual std::size_t DropLive() = 0;
};

/// The calls by which a drone speaks, beside any streams. They keep the robot in memory, and their
/// waiting records count for the robot in the journal's bounds. They take the robot from no stream,
/// and claim no presence: the robot's holder judges that by their signs of life.
///
/// Thread: thread-safe.
class Calls final {
 public:
  /// It spoke by calls, in this or another process.
  void NoteSpoken() { spoke_.store(true); }
  [[nodiscard]] bool spoke() const { return spoke_.load(); }

  /// Begins to serve its calls. `live` outlives the matching End; null: they have no live data.
  void Begin(CallsLive* live) {
    NoteSpoken();
    open_.fetch_add(1);
    const std::lock_guard lock(mutex_);
    live_ = live;
  }
  /// Ends serving its calls; no record of them waits. One for each Begin, with the same `live`.
  void End(const CallsLive* live) {
    open_.fetch_sub(1);
    const std::lock_guard lock(mutex_);
    if (live_ == live) live_ = nullptr;
  }
  [[nodiscard]] bool open() const { return open_.load() > 0; }

  /// Do not call it while holding the lock of `live`.
  [[nodiscard]] std::size_t live_bytes() const {
    const std::lock_guard lock(mutex_);
    return live_ == nullptr ? 0 : live_->live_bytes();
  }
  std::size_t DropLive() {
    const std::lock_guard lock(mutex_);
    return live_ == nullptr ? 0 : live_->DropLive();
  }

  /// The robot is about to be forgotten: until then the server of its calls takes no more, and must
  /// End once nothing of them waits.
  void AskToEnd(SteadyTime until) { ended_until_.store(until); }
  [[nodiscard]] bool asked_to_end(SteadyTime now) const { return now < ended_until_.load(); }

  /// Records begin to wait for the store, in the journal or before it.
  void AddWaiting(const JournalUse& use) {
    records_.fetch_add(use.records);
    bytes_.fetch_add(use.bytes);
  }
  /// Records no longer wait.
  void EndWaiting(const JournalUse& use) {
    records_.fetch_sub(use.records);
    bytes_.fetch_sub(use.bytes);
  }
  [[nodiscard]] JournalUse waiting() const { return {records_.load(), bytes_.load()}; }

 private:
  std::atomic<bool> spoke_{false};
  std::atomic<int> open_{0};
  std::atomic<SteadyTime> ended_until_{SteadyTime()};
  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
  mutable std::mutex mutex_;
  CallsLive* live_ = nullptr;
};

}  // namespace uplink::robot
