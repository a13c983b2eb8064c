#include "server/fleet/fleet.h"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace uplink::fleet {

Fleet::Fleet(const Clock& clock, std::size_t robots_max, const robot::PresenceLimits& presence)
    : clock_(clock), robots_max_(robots_max), presence_(presence), started_(clock.Steady()) {}

Fleet::Shard& Fleet::ShardOf(std::string_view ruri) {
  return shards_[std::hash<std::string_view>{}(ruri) % kShards];
}

const Fleet::Shard& Fleet::ShardOf(std::string_view ruri) const {
  return shards_[std::hash<std::string_view>{}(ruri) % kShards];
}

absl::StatusOr<robot::Robot*> Fleet::FindOrAdmit(const model::RobotId& id) {
  Shard& shard = ShardOf(id.ruri);
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.robots.find(id.ruri);
  if (found == shard.robots.end()) return Admit(shard, id);
  found->second->SetFleet(id.fleet);
  return found->second.get();
}

absl::StatusOr<robot::Robot*> Fleet::AdmitNew(const model::RobotId& id) {
  Shard& shard = ShardOf(id.ruri);
  const std::lock_guard lock(shard.mutex);
  if (shard.robots.contains(id.ruri)) return nullptr;
  return Admit(shard, id);
}

absl::StatusOr<robot::Robot*> Fleet::Admit(Shard& shard, const model::RobotId& id) {
  if (size_.fetch_add(1) >= robots_max_) {
    size_.fetch_sub(1);
    return absl::ResourceExhaustedError(
        fmt::format("the server admits no more than {} robots (limits.robots_max)", robots_max_));
  }
  auto robot = std::make_unique<robot::Robot>(std::make_shared<const model::RobotId>(id), started_,
                                              clock_, changed_);
  robot::Robot* admitted = robot.get();
  shard.robots.emplace(id.ruri, std::move(robot));
  const std::lock_guard lock(admitted_mutex_);
  admitted_.push_back(admitted);
  return admitted;
}

robot::Robot* Fleet::Find(std::string_view ruri) const {
  const Shard& shard = ShardOf(ruri);
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.robots.find(std::string(ruri));
  return found == shard.robots.end() ? nullptr : found->second.get();
}

std::vector<robot::Robot*> Fleet::All() const {
  const std::lock_guard lock(admitted_mutex_);
  return admitted_;
}

std::vector<robot::Robot*> Fleet::Sorted() const {
  std::vector<robot::Robot*> robots = All();
  std::ranges::sort(robots, {},
                    [](const robot::Robot* robot) -> const std::string& { return robot->ruri(); });
  return robots;
}

void PresenceTally::Count(robot::Presence presence) {
  switch (presence) {
    case robot::Presence::kUnknown:
      ++unknown;
      break;
    case robot::Presence::kOnline:
      ++online;
      break;
    case robot::Presence::kOffline:
      ++offline;
      break;
  }
}

PresenceCounts Fleet::Sweep(milliseconds session_idle, Hearing hearing) {
  const SteadyTime steady = clock_.Steady();
  const SystemTime system = clock_.System();
  PresenceCounts counts;
  // A sweep that comes late means that we stood still: the robots' messages may lie unread. They
  // are taken before the next sweep, which judges.
  const SteadyTime last = last_sweep_.exchange(steady);
  const bool stalled = last != SteadyTime() && steady - last > kSweepLate;
  stood_still_.store(stalled);
  for (robot::Robot* robot : All()) {
    const bool unheard =
        hearing == Hearing::kBehind || (hearing == Hearing::kHereAlone && !robot->HasStream());
    if (stalled || unheard) robot->state.NoteStall(steady);
    if (stalled) continue;
    robot->sessions.Sweep(steady, session_idle);
    const std::optional<robot::Presence> presence = robot->state.Sweep(steady, system, presence_);
    if (presence) {
      counts.Count(*presence);
    } else {
      counts.elsewhere.Count(robot->state.presence());
    }
  }
  if (stalled) return presence_counts();
  const std::lock_guard lock(counts_mutex_);
  counts_ = counts;
  return counts;
}

PresenceCounts Fleet::presence_counts() const {
  const std::lock_guard lock(counts_mutex_);
  return counts_;
}

}  // namespace uplink::fleet
