#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"

namespace uplink::store {

/// How far past the mark a trusted clock may stand: a server that was off overnight starts without
/// help.
inline constexpr std::chrono::hours kPastMarkMax{24};
/// How far before the mark a trusted clock may stand: further back, its rows would be too old once
/// the clock is right.
inline constexpr std::chrono::hours kBeforeMarkTrusted{24};
/// How far past the mark a doubtful clock may stand, one that jumped or is far ahead of the
/// database: another server with the right time, or an operator, set the mark within this.
inline constexpr std::chrono::minutes kPastMarkDoubtful{2};
/// For so long after a jump, the kernel's word counts only if a database confirms it: a time daemon
/// needs a while to notice that another program moved its clock.
inline constexpr std::chrono::minutes kKernelNotices{15};
/// A clock so far ahead of the database's is doubtful.
inline constexpr std::chrono::hours kAheadOfDatabaseMax{1};
/// How far apart our clock and the database's may be to confirm each other.
inline constexpr std::chrono::minutes kDatabaseAgreesWithin{1};

/// What a look at the clocks found. A value.
struct ClockFacts {
  /// Our civil time.
  SystemTime now;
  /// The store's mark; empty if it has none.
  std::optional<SystemTime> mark;
  /// The kernel says that something keeps its clock synchronised.
  bool kernel_synchronised = false;
  /// The database's clock; empty if the store has none of its own.
  std::optional<SystemTime> database;
  /// How long ago civil time was seen ahead of the monotonic clock; empty if it has come back or
  /// was vouched for since.
  std::optional<milliseconds> since_jump;
  /// The mark or the kernel has vouched for it since the start, and since then civil time has
  /// advanced with the monotonic clock.
  bool advanced_together = false;

  /// True also without a database.
  [[nodiscard]] bool DatabaseAgrees() const;
  /// Something other than the mark says that our clock is right.
  [[nodiscard]] bool Confirmed() const {
    return DatabaseAgrees() && (database || kernel_synchronised);
  }
};

/// Who vouches for the civil clock.
enum class Voucher : std::uint8_t {
  kNone,
  /// It is near the mark. An operator who confirms the clock sets the mark.
  kMark,
  /// The kernel, and the database if there is one.
  kKernel,
  /// Our monotonic clock: civil time was vouched for before, and has not jumped since. So trust
  /// survives a mark that was not set in time, and a store that was away for long.
  kMonotonic,
};

/// A pure function.
[[nodiscard]] Voucher VoucherOf(const ClockFacts& facts);

/// Whether the mark may be set to our time. Our clock must be vouched for; to move the mark back,
/// the database or the kernel must confirm it.
[[nodiscard]] bool MayMoveMark(const ClockFacts& facts);

/// The time for the mark: ours, but not ahead of the database's, since servers share the mark. It
/// is ours even so if an operator confirmed a clock that is far ahead of the database.
[[nodiscard]] SystemTime MarkToSet(const ClockFacts& facts);

/// Why the clock is not vouched for, for people.
[[nodiscard]] std::string WhyNotVouched(const ClockFacts& facts);

/// Whether the kernel says that an NTP daemon or the hypervisor keeps its civil clock synchronised.
/// False also if it may not be asked. Any thread.
[[nodiscard]] bool KernelClockSynchronised();

}  // namespace uplink::store
