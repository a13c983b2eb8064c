#include "server/robot/clock_skew.h"

#include <algorithm>

namespace uplink::robot {

bool ClockSkew::Add(std::int64_t sent_unix_ms, SystemTime now, SteadyTime steady_now) {
  const std::int64_t sample = sent_unix_ms - UnixMs(now);
  if (sample > kClockSkewMax.count() || sample < -kClockSkewMax.count()) return false;
  if (!highest_ms_ || steady_now - window_began_ >= 2 * kClockSkewWindow) {
    highest_before_ms_.reset();
    highest_ms_ = sample;
    window_began_ = steady_now;
  } else if (steady_now - window_began_ >= kClockSkewWindow) {
    highest_before_ms_ = highest_ms_;
    highest_ms_ = sample;
    window_began_ += kClockSkewWindow;
  } else {
    highest_ms_ = std::max(*highest_ms_, sample);
  }
  const std::int64_t estimate = std::max(*highest_ms_, highest_before_ms_.value_or(*highest_ms_));
  const bool changed = estimate_ms_ != estimate;
  estimate_ms_ = estimate;
  return changed;
}

void ClockSkew::BeginWindow() {
  highest_ms_.reset();
  highest_before_ms_.reset();
}

}  // namespace uplink::robot
