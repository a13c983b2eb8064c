#include "server/journal/holds.h"

namespace uplink::journal {

Holds::Told Holds::Begin(robot::CommitClient& client, const storage::RobotRef& robot,
                         const robot::HoldNews& news) {
  Told told;
  switch (robots_.Begin(client, news.since)) {
    case HeldRobots::Hold::kSame:
      return told;
    case HeldRobots::Hold::kInterrupted:
      told = {.begun = true, .interrupted = true, .stream = client.OnFenced(context_.ledger)};
      context_.inbox.LosePresence(robot->ruri);
      break;
    case HeldRobots::Hold::kNew:
      told.begun = true;
      break;
  }
  clients_[robot->ruri] = &client;
  // First: what the robot notes from now on is held against what the store has.
  context_.inbox.HoldPresence(robot->ruri, news.since, news.presence);
  client.OnHeld(news);
  return told;
}

robot::StreamRef Holds::Lose(robot::CommitClient& client, const storage::RobotRef& robot) {
  robots_.Lose(client);
  clients_.erase(robot->ruri);
  const robot::StreamRef stream = client.OnFenced(context_.ledger);
  context_.inbox.LosePresence(robot->ruri);
  return stream;
}

robot::StreamRef Holds::LoseSince(const storage::RobotRef& robot, storage::Epoch since) {
  const auto held = clients_.find(robot->ruri);
  if (held == clients_.end() || robots_.Since(*held->second) != since) return {};
  return Lose(*held->second, robot);
}

}  // namespace uplink::journal
