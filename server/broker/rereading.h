#pragma once

#include <cstdint>
#include <utility>

namespace uplink::broker {

/// Whether the store is asked anew what it has, and which answer counts. While it is, nothing is
/// taken from the durable connection and nothing is acked on it. Confined to its owner's thread.
class Rereading final {
 public:
  /// Asks, once more if it asks already. Returns the number of the request, from 1.
  [[nodiscard]] std::uint64_t Ask() {
    active_ = true;
    return ++asked_;
  }
  /// Whether the answer to that request ends it. One to an earlier request may lack what was
  /// committed since.
  [[nodiscard]] bool EndsWith(std::uint64_t request) {
    return request == asked_ && std::exchange(active_, false);
  }
  /// Without an answer: the lease is gone.
  void End() { active_ = false; }
  [[nodiscard]] bool active() const { return active_; }

 private:
  bool active_ = false;
  std::uint64_t asked_ = 0;
};

}  // namespace uplink::broker
