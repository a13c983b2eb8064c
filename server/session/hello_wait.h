#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

#include "schema/base/clock.h"
#include "server/session/limits.h"

namespace uplink::session {

/// How long a stream may be without its first frame: kHelloWait, or kHelloWaitPressed while
/// connections wait for a place. Confined to the stream's thread.
class HelloWait final {
 public:
  /// `pressed`: connections wait; null if that is unknown.
  explicit HelloWait(const std::atomic<bool>* pressed) : pressed_(pressed) {}

  /// The stream begins. Returns when to check it.
  [[nodiscard]] SteadyTime Begin(SteadyTime now) {
    began_ = now;
    return now + kHelloWaitPressed;
  }
  /// At or after such a time: the limit that it exceeded, if any.
  [[nodiscard]] std::optional<std::chrono::seconds> Over(SteadyTime now) const {
    if (now >= began_ + kHelloWait) return kHelloWait;
    if (pressed_ != nullptr && pressed_->load(std::memory_order_relaxed)) return kHelloWaitPressed;
    return std::nullopt;
  }
  [[nodiscard]] SteadyTime NextLook(SteadyTime now) const {
    return std::min<SteadyTime>(began_ + kHelloWait, now + kHelloLook);
  }

 private:
  const std::atomic<bool>* const pressed_;
  SteadyTime began_{};
};

}  // namespace uplink::session
