#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::storage {

/// What Store::Retain did.
struct Erased {
  /// Rows that went, and whole partitions of days.
  std::size_t rows = 0;
  /// Of those of quarantine: Rejects that are kept for their robots, since no Hello confirmed them.
  std::size_t rejects_kept = 0;
  /// More is left: as much went as one call deletes.
  bool more = false;
};

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
