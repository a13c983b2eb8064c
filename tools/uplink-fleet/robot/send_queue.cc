#include "tools/uplink-fleet/robot/send_queue.h"

namespace uplink::synthetic {

bool SendQueue::Offer(Outgoing message) {
  if (message.keeping == Keeping::kDurable) {
    if (durable_.size() >= kDurableWaitingMax) return false;
    durable_.push_back({next_ticket_++, std::move(message)});
    return true;
  }
  if (live_.size() >= kLiveWaitingMax) {
    gave_way_due_.push_back(live_.front().message.due);
    live_.pop_front();
  }
  live_.push_back({next_ticket_++, std::move(message)});
  return true;
}

void SendQueue::AdmitLater(SteadyTime now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    durable_.push_back({next_ticket_++, std::move(later_.begin()->second)});
    later_.erase(later_.begin());
  }
}

void SendQueue::DueAt(SteadyTime due) {
  for (Waiting& waiting : live_) waiting.message.due = due;
  for (Waiting& waiting : durable_) waiting.message.due = due;
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
  queue.pop_front();
  return message;
}

}  // namespace uplink::synthetic
