#pragma once

#include <csignal>
#include <ctime>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// How long a server has to answer after the second signal. One that works takes milliseconds, so
/// its run is closed and compared; one that is gone is not waited for.
inline constexpr milliseconds kSecondSignalGrace{5'000};

/// SIGINT and SIGTERM, taken synchronously by main; every thread inherits the mask.
///
/// Thread: main's.
class Signals final {
 public:
  explicit Signals(const Clock& clock) : clock_(clock) {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// True if one came within `wait`, or the second one is kSecondSignalGrace ago.
  [[nodiscard]] bool Wait(milliseconds wait) {
    if (second_at_ && clock_.Steady() - *second_at_ > kSecondSignalGrace) return true;
    return Take(wait);
  }
  /// True if one came since the last look.
  [[nodiscard]] bool Came() { return Take(milliseconds(0)); }

 private:
  bool Take(milliseconds wait) {
    const timespec time{static_cast<std::time_t>(wait.count() / 1000),
                        static_cast<long>(wait.count() % 1000) * 1'000'000};
    if (sigtimedwait(&set_, nullptr, &time) <= 0) return false;
    if (came_ && !second_at_) second_at_ = clock_.Steady();
    came_ = true;
    return true;
  }

  const Clock& clock_;
  sigset_t set_{};
  bool came_ = false;
  std::optional<SteadyTime> second_at_;
};

}  // namespace uplink::synthetic
