#include "server/robot/reconnects.h"

#include <algorithm>

namespace uplink::robot {

std::optional<Reconnects::Arrival> Reconnects::Arrive(SteadyTime now,
                                                      const ReconnectLimits& limits) {
  came_.Note(now);
  const std::size_t streams = came_.Within(now, kMinute);
  Arrival arrival{.number = last_number_ + 1};
  if (streams > limits.per_minute) {
    if (waiting_ >= kStreamsWaitingMax) return std::nullopt;
    const std::size_t doublings = streams - limits.per_minute - 1;
    arrival.delay = std::min(kStreamDelayMin * (1U << doublings), limits.delay_max);
    ++waiting_;
  }
  ++last_number_;
  return arrival;
}

bool Reconnects::MayAttach(std::uint64_t number) {
  if (number < attached_) return false;
  attached_ = number;
  return true;
}

}  // namespace uplink::robot
