#pragma once

#include <chrono>
#include <mutex>

#include "schema/base/clock.h"
#include "storage/clock_trust.h"

namespace uplink::store {

/// How far civil time may run ahead of the monotonic clock between two looks. An NTP daemon slews
/// by a tenth at most; looks are seconds apart.
inline constexpr std::chrono::seconds kAdvanceTolerance{5};

/// Both clocks, read at one moment. A value.
struct ClockPair {
  SteadyTime steady;
  SystemTime system;

  [[nodiscard]] static ClockPair Of(const Clock& clock) { return {clock.Steady(), clock.System()}; }
  /// By how much civil time ran ahead of the monotonic clock since `before`; negative: behind.
  [[nodiscard]] milliseconds AheadSince(const ClockPair& before) const {
    return (system - before.system) -
           std::chrono::duration_cast<milliseconds>(steady - before.steady);
  }
};

/// The judgement of the civil clock, as of the last look. It ends once civil time runs ahead of the
/// monotonic clock, so that nothing is deleted between a jump and the next look.
///
/// Thread: thread-safe.
class VouchedClock final : public storage::ClockTrust {
 public:
  /// Starts without trust. `clock` must outlive this.
  explicit VouchedClock(const Clock& clock);
  VouchedClock(const VouchedClock&) = delete;
  VouchedClock& operator=(const VouchedClock&) = delete;

  [[nodiscard]] bool vouched() const override { return VouchesFor(clock_.System()); }
  [[nodiscard]] bool VouchesFor(SystemTime time) const override;
  /// Notes what a look judged, when both clocks stood at `at`.
  void Note(bool vouched, const ClockPair& at);
  /// By how much civil time ran ahead of the monotonic clock since this was made.
  [[nodiscard]] milliseconds ahead() const { return ClockPair::Of(clock_).AheadSince(made_); }

 private:
  const Clock& clock_;
  const ClockPair made_;
  mutable std::mutex mutex_;
  bool vouched_ = false;
  ClockPair judged_;
};

}  // namespace uplink::store
