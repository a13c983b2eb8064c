#include "server/session/ack_release.h"

#include <algorithm>
#include <chrono>

#include "server/session/frames.h"

namespace uplink::session {

void AckRelease::AddProcessed(const Intake::Processed& processed) {
  unacked_messages_ += processed.messages;
  if (processed.ack_owed || unacked_messages_ >= kAckMessages) due_ = true;
  if (unacked_messages_ > 0 && !timers_.is_set(Timer::kAck)) {
    timers_.Set(Timer::kAck, context_.clock.Steady() + context_.limits.ack_interval);
  }
}

void AckRelease::AddProgress(const robot::Progress& progress) {
  AddReleased(progress.released);
  if (progress.through > acked_through_) due_ = true;
}

void AckRelease::AddReleased(const std::vector<SteadyTime>& released) {
  // Arrivals only feed a histogram: past the bound the peer does not read, and they are dropped.
  const std::size_t room = kReleasedMax - std::min(kReleasedMax, released_.size());
  const auto count = static_cast<std::ptrdiff_t>(std::min(room, released.size()));
  released_.insert(released_.end(), released.begin(), released.begin() + count);
}

v1::RelayResponse AckRelease::Release(const robot::Progress& progress) {
  acked_through_ = std::max(acked_through_, progress.through);
  acked_judged_ = std::max(acked_judged_, progress.judged);
  due_ = false;
  timers_.Clear(Timer::kAck);
  unacked_messages_ = 0;
  const SteadyTime now = context_.clock.Steady();
  for (const SteadyTime arrived : released_) {
    context_.probe.ack_seconds.Observe(std::chrono::duration<double>(now - arrived).count());
  }
  released_.clear();
  context_.probe.acks_total.Add();
  return AckFrame(acked_through_, acked_judged_);
}

}  // namespace uplink::session
