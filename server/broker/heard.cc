#include "server/broker/heard.h"

#include <utility>

#include "server/broker/limits.h"

namespace uplink::broker {
namespace {

bool IsStopped(const mqtt::ClientProbe& durable) {
  return durable.stopped_by_window.value() + durable.stopped_by_output.value() +
             durable.stopped_by_core.value() >
         0;
}

}  // namespace

void Heard::Look(bool subscribed, const mqtt::ClientProbe& durable, std::size_t unacked_max) {
  const SteadyTime now = clock_.Steady();
  const bool unread = IsUnread(durable);
  const bool behind = IsBehind(durable, unacked_max);
  if (!behind || !subscribed) {
    behind_since_.reset();
  } else if (!behind_since_) {
    behind_since_ = now;
  }
  const bool long_behind = behind_since_ && now - *behind_since_ >= kBehindShownAfter;
  probe_.unread.Set(subscribed && (unread || long_behind) ? 1 : 0);
  if (!subscribed) {
    heard_at_.store(SteadyTime());
  } else if (!behind) {
    heard_at_.store(now);
  }
  const std::lock_guard lock(mutex_);
  if (!subscribed) {
    subscribed_since_.reset();
  } else if (!subscribed_since_) {
    subscribed_since_ = clock_.System();
  }
}

bool Heard::IsBehind(const mqtt::ClientProbe& durable, std::size_t unacked_max) {
  const std::int64_t stops = durable.window_stops.value() + probe_.held_total.value();
  const bool moved = std::exchange(stops_then_, stops) != stops;
  const bool full = durable.unacked.value() >= static_cast<std::int64_t>(unacked_max);
  return moved || full || stuck_ || IsStopped(durable);
}

bool Heard::IsUnread(const mqtt::ClientProbe& durable) {
  const std::int64_t messages = durable.messages[0].value() + durable.messages[1].value();
  // By 3.1.1 the window is the broker's own: it is full where nothing that came is acked any more.
  const std::int64_t pubacks = durable.pubacks.value();
  stuck_ = std::exchange(pubacks_then_, pubacks) == pubacks && durable.unacked.value() > 0;
  const bool stopped = IsStopped(durable) || stuck_;
  const bool moved = std::exchange(messages_then_, messages) != messages;
  const SteadyTime now = clock_.Steady();
  if (!stopped || moved) {
    unread_since_.reset();
  } else if (!unread_since_) {
    unread_since_ = now;
  }
  return unread_since_ && now - *unread_since_ >= kUnreadAfter;
}

fleet::Fleet::Hearing Heard::hearing() const {
  const SteadyTime heard_at = heard_at_.load();
  const bool hears = heard_at != SteadyTime() && clock_.Steady() - heard_at < kTickLate;
  return hears ? fleet::Fleet::Hearing::kUpToDate : fleet::Fleet::Hearing::kBehind;
}

std::optional<SystemTime> Heard::subscribed_since() const {
  const std::lock_guard lock(mutex_);
  return subscribed_since_;
}

}  // namespace uplink::broker
