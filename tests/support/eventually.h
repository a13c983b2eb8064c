#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "schema/base/clock.h"

namespace uplink::testing {

/// The longest that a test waits for something that must happen; a machine under load is slow.
inline constexpr std::chrono::milliseconds kPatience{20'000};

/// Waits until `condition` holds; false if it does not within `patience`. For conditions that
/// nothing announces to the test.
[[nodiscard]] inline bool Eventually(const std::function<bool()>& condition,
                                     std::chrono::milliseconds patience = kPatience) {
  const auto end = SystemClock{}.Steady() + patience;
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  while (!condition()) {
    if (SystemClock{}.Steady() >= end) return false;
    never.wait_for(lock, std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace uplink::testing
