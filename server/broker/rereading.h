#pragma once

#include <cstdint>
#include <utility>

namespace uplink::broker {

/// Tracks requests to read again what the store has. During one, nothing is taken from the durable
/// connection and nothing is acked on it. Confined to its owner's thread.
class Rereading final {
 public:
  /// Starts a request, also if one is under way. Returns its number, from 1.
  [[nodiscard]] std::uint64_t Ask() {
    active_ = true;
    return ++asked_;
  }
  /// Whether the answer to that request ends it. An answer to an earlier request may lack later
  /// commits.
  [[nodiscard]] bool EndOnAnswer(std::uint64_t request) {
    return request == asked_ && std::exchange(active_, false);
  }
  /// Ends it without an answer: the lease is gone.
  void End() { active_ = false; }
  [[nodiscard]] bool active() const { return active_; }

 private:
  bool active_ = false;
  std::uint64_t asked_ = 0;
};

}  // namespace uplink::broker
