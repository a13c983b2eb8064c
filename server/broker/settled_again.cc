#include "server/broker/settled_again.h"

#include <utility>

namespace uplink::broker {

void SettledAgain::Add(const mqtt::AckHandle& ack) {
  next_.push_back(ack);
  if (!asked_) Ask();
}

std::vector<mqtt::AckHandle> SettledAgain::Answered() {
  asked_ = false;
  std::vector<mqtt::AckHandle> covered = std::exchange(covered_, {});
  if (!next_.empty()) Ask();
  return covered;
}

void SettledAgain::Clear() {
  covered_.clear();
  next_.clear();
}

void SettledAgain::Ask() {
  asked_ = true;
  covered_ = std::exchange(next_, {});
  journal_.WhenCommitted({.inbox = &inbox_, .stream = 0});
}

}  // namespace uplink::broker
