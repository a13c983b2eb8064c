#pragma once

#include <chrono>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::storage {

/// The day (UTC) of a time.
[[nodiscard]] inline std::chrono::sys_days DayOf(SystemTime time) {
  return std::chrono::floor<std::chrono::days>(time);
}

/// The first day that is kept: what arrived before it goes. Nothing if `retain` is zero: all stays.
[[nodiscard]] inline std::optional<std::chrono::sys_days> FirstDayKept(SystemTime now,
                                                                       milliseconds retain) {
  if (retain.count() == 0) return std::nullopt;
  return DayOf(now - retain);
}

}  // namespace uplink::storage
