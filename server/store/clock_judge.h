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
/// How far before the mark: its rows would be too old as soon as the clock is right.
inline constexpr std::chrono::hours kBeforeMarkTrusted{24};
/// Past the mark after a jump, or far ahead of the database: whoever has the right time, or an
/// operator, set it within this.
inline constexpr std::chrono::minutes kPastMarkDoubtful{2};
/// So long after a jump the kernel's word does not count where there is no database to confirm it:
/// what keeps a clock synchronised takes a while to notice that somebody else moved it.
inline constexpr std::chrono::minutes kKernelNotices{15};
/// A clock that stands so far ahead of the database's is doubtful.
inline constexpr std::chrono::hours kAheadOfDatabaseMax{1};
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
  /// How long ago civil time was seen to run ahead of the monotonic clock, if it has not come back
  /// and nobody vouched for it since.
  std::optional<milliseconds> since_jump;
  /// The mark or the kernel vouched for it since the start, and civil time has gone with the
  /// monotonic clock from there on, neither ahead nor back.
  bool went_together = false;

  /// True also where there is no database to disagree.
  [[nodiscard]] bool DatabaseAgrees() const;
  /// Something other than the mark says that our clock is right.
  [[nodiscard]] bool Confirmed() const {
    return DatabaseAgrees() && (database || kernel_synchronised);
  }
};

/// Who vouches for the civil clock.
enum class Voucher : std::uint8_t {
  kNobody,
  /// It is near the mark. An operator who confirms the clock sets the mark.
  kMark,
  /// The kernel, and the database if there is one.
  kKernel,
  /// Our own monotonic clock: it was vouched for before, and has not jumped since. So a mark that
  /// could not be set in time, or a store that was away for long, ends no trust.
  kMonotonic,
};

/// A pure function.
[[nodiscard]] Voucher VoucherOf(const ClockFacts& facts);

/// Whether the mark may be set to our time: not by a server for which nobody vouches, and back only
/// by one whose clock the database or the kernel confirms.
[[nodiscard]] bool MayMoveMark(const ClockFacts& facts);

/// To which time: ours, but not ahead of the database's, since servers share the mark. Where an
/// operator confirmed a clock that is far ahead of it, ours all the same.
[[nodiscard]] SystemTime MarkToSet(const ClockFacts& facts);

/// Why nobody vouches for the clock, for people.
[[nodiscard]] std::string WhyNobodyVouches(const ClockFacts& facts);

/// The kernel says that something (an NTP daemon, the hypervisor) keeps its civil clock
/// synchronised. False also where it may not be asked. Any thread.
[[nodiscard]] bool KernelClockSynchronised();

}  // namespace uplink::store
