#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>

#include "schema/base/clock.h"
#include "server/robot/commit_client.h"

namespace uplink::robot {

/// What a robot's calls say now, which counts in the budget of live state. Thread-safe.
class CallsLive {
 public:
  virtual ~CallsLive() = default;
  [[nodiscard]] virtual std::size_t live_bytes() const = 0;
  /// Holds none of it until it is said again. Returns the bytes that it freed.
  virtual std::size_t DropLive() = 0;
};

/// The calls by which a robot speaks beside the streams that it may have (a drone). They keep it in
/// memory, and what waits of them counts as the robot's in the journal's bounds. They take it from
/// no stream, and claim no presence: whoever holds the robot judges it, by the signs of life that
/// its calls are.
///
/// Thread: thread-safe.
class Calls final {
 public:
  /// It spoke by calls, in whatever process.
  void NoteSpoken() { spoke_.store(true); }
  [[nodiscard]] bool spoke() const { return spoke_.load(); }

  /// Its calls are served from now on. `live` is there until End; null: they say nothing live.
  void Begin(CallsLive* live) {
    NoteSpoken();
    open_.fetch_add(1);
    const std::lock_guard lock(mutex_);
    live_ = live;
  }
  /// They are served no more, and nothing of them waits. One for each Begin, of the same `live`.
  void End(const CallsLive* live) {
    open_.fetch_sub(1);
    const std::lock_guard lock(mutex_);
    if (live_ == live) live_ = nullptr;
  }
  [[nodiscard]] bool open() const { return open_.load() > 0; }

  /// Not while the lock of what says it is held.
  [[nodiscard]] std::size_t live_bytes() const {
    const std::lock_guard lock(mutex_);
    return live_ == nullptr ? 0 : live_->live_bytes();
  }
  std::size_t DropLive() {
    const std::lock_guard lock(mutex_);
    return live_ == nullptr ? 0 : live_->DropLive();
  }

  /// The robot is to be forgotten: until then who serves its calls takes no more, and is to End
  /// once nothing of them waits.
  void AskToEnd(SteadyTime until) { ended_until_.store(until); }
  [[nodiscard]] bool asked_to_end(SteadyTime now) const { return now < ended_until_.load(); }

  /// This waits for the store from now on, in the journal or before it.
  void AddWaiting(const JournalUse& use) {
    records_.fetch_add(use.records);
    bytes_.fetch_add(use.bytes);
  }
  /// This does so no more.
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
