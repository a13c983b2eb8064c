#pragma once

#include <atomic>
#include <cstddef>

#include "server/robot/commit_client.h"

namespace uplink::robot {

/// The calls by which a robot speaks beside the streams that it may have (a drone). They keep it in
/// memory, and what waits of them counts as the robot's in the journal's bounds. They take it from
/// no stream, and claim no presence: whoever holds the robot judges it, by the signs of life that
/// its calls are.
///
/// Thread: thread-safe.
class Calls final {
 public:
  /// Its calls are served from now on.
  void Begin() { open_.fetch_add(1); }
  /// They are served no more, and nothing of them waits. One for each Begin.
  void End() {
    if (open_.fetch_sub(1) == 1) asked_to_end_.store(false);
  }
  [[nodiscard]] bool open() const { return open_.load() > 0; }

  /// The robot is to be forgotten: who serves its calls is to End once nothing of them waits, and
  /// takes no more until then.
  void AskToEnd() {
    if (open()) asked_to_end_.store(true);
  }
  [[nodiscard]] bool asked_to_end() const { return asked_to_end_.load(); }

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
  std::atomic<int> open_{0};
  std::atomic<bool> asked_to_end_{false};
  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
};

}  // namespace uplink::robot
