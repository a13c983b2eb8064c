#include "server/robot/reconnects.h"

#include <algorithm>
#include <chrono>

namespace uplink::robot {

std::optional<Reconnects::Arrival> Reconnects::Arrive(SteadyTime now,
                                                      const ReconnectLimits& limits) {
  Remember(now);
  Arrival arrival{.number = last_number_ + 1};
  if (remembered_ > limits.per_minute) {
    if (waiting_ >= kStreamsWaitingMax) return std::nullopt;
    const std::size_t doublings = remembered_ - limits.per_minute - 1;
    arrival.delay = std::min(kStreamDelayMin * (1U << doublings), limits.delay_max);
    ++waiting_;
  }
  ++last_number_;
  return arrival;
}

void Reconnects::Remember(SteadyTime now) {
  const auto end = came_.begin() + static_cast<std::ptrdiff_t>(remembered_);
  auto kept = std::find_if(
      came_.begin(), end, [now](SteadyTime came) { return now - came <= std::chrono::minutes(1); });
  // More times would make no stream wait longer.
  if (kept == came_.begin() && end == came_.end()) ++kept;
  const auto free = std::shift_left(came_.begin(), end, kept - came_.begin());
  *free = now;
  remembered_ = static_cast<std::size_t>(free - came_.begin()) + 1;
}

bool Reconnects::MayAttach(std::uint64_t number) {
  if (number < attached_) return false;
  attached_ = number;
  return true;
}

}  // namespace uplink::robot
