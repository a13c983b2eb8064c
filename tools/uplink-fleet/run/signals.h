#pragma once

#include <csignal>
#include <ctime>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// SIGINT and SIGTERM, taken synchronously by main; every thread inherits the mask.
class Signals {
 public:
  Signals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// True if one came within `wait`.
  [[nodiscard]] bool Wait(milliseconds wait) const {
    const timespec time{static_cast<std::time_t>(wait.count() / 1000),
                        static_cast<long>(wait.count() % 1000) * 1'000'000};
    return sigtimedwait(&set_, nullptr, &time) > 0;
  }

 private:
  sigset_t set_{};
};

}  // namespace uplink::synthetic
