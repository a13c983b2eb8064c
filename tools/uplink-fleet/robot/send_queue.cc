#include "tools/uplink-fleet/robot/send_queue.h"

namespace uplink::synthetic {

bool SendQueue::Offer(Outgoing message) {
  if (message.keeping == Keeping::kDurable) {
    if (!message.latest_of.empty()) ReplaceAll(message.latest_of);
    if (durable_waiting() >= kDurableWaitingMax) return false;
    PushDurable(std::move(message));
    return true;
  }
  if (live_.size() >= kLiveWaitingMax) {
    gave_way_due_.push_back(live_.front().message.due);
    live_.pop_front();
  }
  live_.push_back({next_ticket_++, std::move(message)});
  return true;
}

void SendQueue::PushDurable(Outgoing message) {
  durable_.push_back({next_ticket_++, std::move(message)});
  Waiting& waiting = durable_.back();
  if (!waiting.message.latest_of.empty()) latest_[waiting.message.latest_of] = &waiting;
}

void SendQueue::ReplaceAll(const std::string& latest_of) {
  std::erase_if(later_, [&](const auto& later) {
    if (later.second.latest_of != latest_of) return false;
    Replace(later.second);
    return true;
  });
  const auto waits = latest_.find(latest_of);
  if (waits == latest_.end()) return;
  Replace(waits->second->message);
  waits->second->replaced = true;
  ++durable_replaced_;
  latest_.erase(waits);
  DropReplaced();
}

void SendQueue::DropReplaced() {
  while (!durable_.empty() && durable_.front().replaced) {
    durable_.pop_front();
    --durable_replaced_;
  }
}

void SendQueue::OfferLater(Outgoing message, SteadyTime when) {
  if (latest_.contains(message.latest_of)) return Replace(message);
  later_.emplace(when, std::move(message));
}

void SendQueue::AdmitLater(SteadyTime now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    PushDurable(std::move(later_.begin()->second));
    later_.erase(later_.begin());
  }
}

void SendQueue::DueAt(SteadyTime due) {
  for (Waiting& waiting : live_) waiting.message.due = due;
  for (Waiting& waiting : durable_) waiting.message.due = due;
}

Unsent SendQueue::unsent() const {
  Unsent unsent;
  if (!live_.empty()) unsent.Add(live_.size(), live_.front().message.due);
  if (!durable_.empty()) unsent.Add(durable_waiting(), durable_.front().message.due);
  for (const auto& [when, message] : later_) unsent.Add(1, message.due);
  return unsent;
}

std::deque<SendQueue::Waiting>* SendQueue::Longest() {
  if (live_.empty()) return durable_.empty() ? nullptr : &durable_;
  if (durable_.empty()) return &live_;
  return live_.front().ticket < durable_.front().ticket ? &live_ : &durable_;
}

const Outgoing* SendQueue::Next() {
  const std::deque<Waiting>* const queue = Longest();
  return queue == nullptr ? nullptr : &queue->front().message;
}

Outgoing SendQueue::TakeNext() {
  std::deque<Waiting>& queue = *Longest();
  Outgoing message = std::move(queue.front().message);
  if (!message.latest_of.empty()) latest_.erase(message.latest_of);
  queue.pop_front();
  DropReplaced();
  return message;
}

}  // namespace uplink::synthetic
