#include "server/journal/holds.h"

#include <algorithm>

namespace uplink::journal {

Holds::BeginResult Holds::Begin(robot::CommitClient& client, const storage::RobotRef& robot,
                                const robot::HoldNews& news) {
  BeginResult result;
  Held& held = held_[robot->ruri];
  // Another robot of the same name, whose owner let go of it, is no longer held.
  if (held.client.get() != nullptr && held.client.get() != &client) robots_.Lose(*held.client);
  held = {&client, robot};
  switch (robots_.Begin(client, news.since)) {
    case HeldRobots::Hold::kSame:
      return result;
    case HeldRobots::Hold::kInterrupted:
      result = {.begun = true, .interrupted = true, .stream = client.OnFenced(context_.ledger)};
      context_.inbox.LosePresence(robot->ruri);
      break;
    case HeldRobots::Hold::kNew:
      result.begun = true;
      break;
  }
  // First: later notes of the robot are compared with what the store has.
  context_.inbox.HoldPresence(robot->ruri, news.since, news.presence);
  client.OnHeld(news);
  return result;
}

loop::StreamRef Holds::Lose(robot::CommitClient& client, const storage::RobotRef& robot) {
  robots_.Lose(client);
  // The map's entry, to which the references may lead, is erased before their last use.
  const robot::ClientRef kept_client(&client);
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): the copy keeps it alive
  const storage::RobotRef kept = robot;
  held_.erase(kept->ruri);
  const loop::StreamRef stream = client.OnFenced(context_.ledger);
  context_.inbox.LosePresence(kept->ruri);
  return stream;
}

loop::StreamRef Holds::LoseSince(const std::string& ruri, storage::Epoch since) {
  const auto held = held_.find(ruri);
  if (held == held_.end() || robots_.Since(*held->second.client) != since) return {};
  return Lose(*held->second.client, held->second.robot);
}

loop::StreamRef Holds::WentBack(const std::string& ruri) {
  const auto held = held_.find(ruri);
  return held == held_.end() ? loop::StreamRef() : held->second.client->OnWentBack(context_.ledger);
}

bool Holds::FollowPresence(const std::string& ruri,
                           const std::optional<storage::StoredPresence>& stored, Reconnected to) {
  const auto held = held_.find(ruri);
  return held != held_.end() && context_.inbox.FollowPresence(held->second.robot, stored, to);
}

std::vector<storage::ToldRobot> Holds::ToldOfAll() const {
  std::vector<storage::ToldRobot> told;
  told.reserve(held_.size());
  for (const auto& [ruri, held] : held_) {
    told.push_back({.ruri = ruri,
                    .held_since = robots_.Since(*held.client),
                    .sessions = held.client->Committed()});
  }
  // Sorted, so that a run repeats exactly.
  std::ranges::sort(told, {}, &storage::ToldRobot::ruri);
  return told;
}

}  // namespace uplink::journal
