#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"

namespace uplink::store {

/// How far past the mark a clock may stand and be trusted: a server that was off over night starts
/// without anybody's help.
inline constexpr std::chrono::hours kPastMarkMax{24};
/// How far apart our clock and the database's may be for the one to confirm the other.
inline constexpr std::chrono::minutes kDatabaseAgreesWithin{1};

/// What a look at the clocks found. A value.
struct ClockFacts {
  /// Our civil time.
  SystemTime now;
  /// The store's mark; nothing if it has none.
  std::optional<SystemTime> mark;
  /// The kernel says that something keeps its clock synchronised.
  bool kernel_synchronised = false;
  /// The database's clock; nothing if the store has none of its own.
  std::optional<SystemTime> database;

  /// True also where there is no database to disagree.
  [[nodiscard]] bool DatabaseAgrees() const;
};

/// Who vouches for the civil clock.
enum class Voucher : std::uint8_t {
  kNobody,
  /// It is before the mark, or not far past it. An operator who confirms the clock sets the mark.
  kMark,
  /// The kernel, and the database if there is one.
  kKernel,
};

/// A pure function.
[[nodiscard]] Voucher VoucherOf(const ClockFacts& facts);

/// Whether the mark may be set to our time: not by a server for which nobody vouches, and not back
/// by one that the database contradicts, since servers share the mark.
[[nodiscard]] bool MayMoveMark(const ClockFacts& facts);

/// Why nobody vouches for the clock, for people.
[[nodiscard]] std::string WhyNobodyVouches(const ClockFacts& facts);

}  // namespace uplink::store
