#include "server/store/marked_clock.h"

namespace uplink::store {

SystemTime MarkedClock::System() const {
  const SystemTime civil = machine_.System();
  const std::int64_t mark_less_steady_ms = mark_less_steady_ms_.load();
  if (mark_less_steady_ms == kNone) return civil;
  const SystemTime marked = FromUnixMs(mark_less_steady_ms + SteadyMs(machine_.Steady()));
  return marked - civil > kBeforeMarkMax ? marked : civil;
}

void MarkedClock::NoteMark(SystemTime mark, SteadyTime at) {
  mark_less_steady_ms_.store(UnixMs(mark) - SteadyMs(at));
}

}  // namespace uplink::store
