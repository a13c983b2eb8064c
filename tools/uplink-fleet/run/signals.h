#pragma once

#include <csignal>
#include <ctime>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// SIGINT and SIGTERM, taken synchronously by main; every thread inherits the mask. After the
/// second one nothing is waited for any more.
///
/// Thread: main's.
class Signals final {
 public:
  Signals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// True if one came within `wait`, or two have come by now.
  [[nodiscard]] bool Wait(milliseconds wait) { return came_ >= kToldTwice || Take(wait); }
  /// True if one came since the last look.
  [[nodiscard]] bool Came() { return Take(milliseconds(0)); }

 private:
  static constexpr int kToldTwice = 2;

  bool Take(milliseconds wait) {
    const timespec time{static_cast<std::time_t>(wait.count() / 1000),
                        static_cast<long>(wait.count() % 1000) * 1'000'000};
    if (sigtimedwait(&set_, nullptr, &time) <= 0) return false;
    ++came_;
    return true;
  }

  sigset_t set_{};
  int came_ = 0;
};

}  // namespace uplink::synthetic
