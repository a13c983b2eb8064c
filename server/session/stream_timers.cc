#include "server/session/stream_timers.h"

namespace uplink::session {

std::optional<SteadyTime> StreamTimers::Next() const {
  std::optional<SteadyTime> first;
  for (const std::optional<SteadyTime>& at : at_) {
    if (at && (!first || *at < *first)) first = at;
  }
  return first;
}

}  // namespace uplink::session
