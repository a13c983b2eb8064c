#include "server/broker/broker_health.h"

#include <utility>

#include <fmt/core.h>

#include "server/broker/limits.h"

namespace uplink::broker {
namespace {

bool IsLiveBehind(const BrokerHealth::Connections& connections) {
  return connections.live_unread >= kLiveBehindBytes ||
         connections.live_ping_waited >= kLivePingWaitMax;
}

bool IsStopped(const mqtt::ClientProbe& durable) {
  return durable.stopped_by_window.value() + durable.stopped_by_output.value() +
             durable.stopped_by_core.value() >
         0;
}

}  // namespace

void BrokerHealth::Update(const Connections& connections, const mqtt::ClientProbe& durable) {
  const SteadyTime now = clock_.Steady();
  const bool subscribed = connections.subscribed;
  const Progress progress = NoteProgress(durable, connections);
  if (!progress.stopped || progress.read) {
    unread_since_.reset();
  } else if (!unread_since_) {
    unread_since_ = now;
  }
  if (!progress.behind || !subscribed) {
    behind_since_.reset();
  } else if (!behind_since_) {
    behind_since_ = now;
  }
  if (!IsLiveBehind(connections) || !subscribed) {
    live_behind_since_.reset();
  } else if (!live_behind_since_) {
    live_behind_since_ = now;
  }
  const bool unread = unread_since_ && now - *unread_since_ >= kUnreadAfter;
  const bool long_behind = behind_since_ && now - *behind_since_ >= kBehindShownAfter;
  if (live_is_old()) live_old_at_ = now;
  const bool live_was_old = live_old_at_ && now - *live_old_at_ < kLiveBehindShown;
  probe_.behind.Set((subscribed && (unread || long_behind)) || live_was_old ? 1 : 0);
  if (!subscribed) {
    heard_at_.store(SteadyTime());
  } else if (!progress.behind) {
    heard_at_.store(now);
  }
  const std::lock_guard lock(mutex_);
  if (!subscribed) {
    subscribed_since_.reset();
  } else if (!subscribed_since_) {
    subscribed_since_ = clock_.System();
  }
}

BrokerHealth::Progress BrokerHealth::NoteProgress(const mqtt::ClientProbe& durable,
                                                  const Connections& connections) {
  const std::int64_t messages = durable.messages[0].value() + durable.messages[1].value();
  const std::int64_t pubacks = durable.pubacks.value();
  const std::int64_t stops = durable.window_stops.value() + probe_.held_back_total.value();
  const std::int64_t unacked = durable.unacked.value();
  // With MQTT 3.1.1 the broker sets the window: it is full if messages came and none is acked any
  // more.
  const bool stuck = std::exchange(pubacks_then_, pubacks) == pubacks && unacked > 0;
  const bool stopped = IsStopped(durable) || stuck;
  const bool stopped_since = std::exchange(stops_then_, stops) != stops;
  const bool full = unacked >= static_cast<std::int64_t>(connections.unacked_max);
  return {.read = std::exchange(messages_then_, messages) != messages,
          .stopped = stopped,
          .behind = stopped || stopped_since || full || IsLiveBehind(connections)};
}

bool BrokerHealth::live_is_old() const {
  return live_behind_since_ && clock_.Steady() - *live_behind_since_ >= kLiveBehindMax;
}

fleet::Fleet::HearingState BrokerHealth::hearing() const {
  const SteadyTime heard_at = heard_at_.load();
  const bool hears = heard_at != SteadyTime() && clock_.Steady() - heard_at < kTickLate;
  return hears ? fleet::Fleet::HearingState::kUpToDate : fleet::Fleet::HearingState::kBehind;
}

std::optional<SystemTime> BrokerHealth::subscribed_since() const {
  const std::lock_guard lock(mutex_);
  return subscribed_since_;
}

mqtt::End BehindEnd() {
  return {mqtt::EndReason::kBehind,
          fmt::format("behind: at each look of {} s more than {} KiB lay unread, or a ping had no "
                      "answer for {} s",
                      kLiveBehindMax.count(), kLiveBehindBytes / 1024, kLivePingWaitMax.count())};
}

}  // namespace uplink::broker
