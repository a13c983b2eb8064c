#include "server/store/vouched_clock.h"

namespace uplink::store {

VouchedClock::VouchedClock(const Clock& clock)
    : clock_(clock), made_(ClockPair::Of(clock)), judged_(made_) {}

bool VouchedClock::VouchesFor(SystemTime time) const {
  const std::lock_guard lock(mutex_);
  // Read under the lock: a judgement that came meanwhile would be ahead of it.
  const ClockPair now = ClockPair::Of(clock_);
  return vouched_ && now.AheadSince(judged_) <= kAdvanceTolerance &&
         time <= now.system + kAdvanceTolerance;
}

void VouchedClock::Note(bool vouched, const ClockPair& at) {
  const std::lock_guard lock(mutex_);
  vouched_ = vouched;
  judged_ = at;
}

}  // namespace uplink::store
