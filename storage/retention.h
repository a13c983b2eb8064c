#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"

namespace uplink::storage {

/// What Store::Sweep deleted.
struct Swept {
  /// Shapes and objects that had expired.
  std::size_t items = 0;
  /// Changes of shared items that no reader needs any more (shared_items.h).
  std::size_t changes = 0;
};

/// What Store::TrimQuarantine did.
struct Trimmed {
  /// Rows that went; index: RejectReason.
  std::array<std::size_t, model::kRejectReasons + 1> dropped{};
  /// Places in the request of robots that lost kTrimRowsMax rows: there may be more.
  std::vector<std::size_t> unfinished;
};

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
