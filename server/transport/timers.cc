#include "server/transport/timers.h"

#include <algorithm>

namespace uplink::transport {
namespace {

/// The first tick that is at or after `time`.
SteadyTime TickAt(SteadyTime time) {
  const auto since = time.time_since_epoch();
  const auto whole = since / kTimerTick * kTimerTick;
  return SteadyTime(whole < since ? whole + kTimerTick : SteadyTime::duration(whole));
}

}  // namespace

void Timers::Want(std::uint64_t stream, Slot& slot, SteadyTime deadline, SteadyTime now) {
  const SteadyTime at = TickAt(std::max(deadline, now + SteadyTime::duration(1)));
  if (slot && *slot <= at) return;
  Forget(stream, slot);
  entries_.emplace(at, stream);
  slot = at;
}

void Timers::Forget(std::uint64_t stream, Slot& slot) {
  if (!slot) return;
  entries_.erase({*slot, stream});
  slot.reset();
}

std::optional<SteadyTime> Timers::next() const {
  if (entries_.empty()) return std::nullopt;
  return entries_.begin()->first;
}

std::optional<std::uint64_t> Timers::PopDue(SteadyTime now) {
  if (entries_.empty() || entries_.begin()->first > now) return std::nullopt;
  const std::uint64_t stream = entries_.begin()->second;
  entries_.erase(entries_.begin());
  return stream;
}

}  // namespace uplink::transport
