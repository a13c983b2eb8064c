#include "tests/support/fake_database.h"

namespace uplink::testing {

std::vector<storage::FoundRobot> FakeDatabase::Compare(
    const storage::ProcessId& process, std::span<const storage::ToldRobot> robots) const {
  const std::lock_guard lock(mutex_);
  std::vector<storage::FoundRobot> found(robots.size());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto known = robots_.find(robots[i].ruri);
    const Robot* const robot = known == robots_.end() ? nullptr : &known->second;
    if (robot != nullptr && robot->epoch != 0) {
      found[i].held = robot->owner == process &&
                      (holds_by_owner_alone_ || robot->held_since == robots[i].held_since);
      found[i].went_back = robot->held_since < robots[i].held_since;
      if (robot->held_since > robots[i].held_since) continue;
    }
    for (const storage::CommittedSession& told : robots[i].sessions) {
      const auto session = robot == nullptr ? decltype(robot->sessions.begin())()
                                            : robot->sessions.find(told.session);
      const bool there = robot != nullptr && session != robot->sessions.end();
      if ((there ? session->second.cursor : 0) < told.cursor) found[i].went_back = true;
    }
    if (found[i].held) found[i].presence = presence_.Last(robots[i].ruri);
  }
  return found;
}

storage::Epoch FakeDatabase::HeldSinceOf(std::string_view ruri) const {
  const std::lock_guard lock(mutex_);
  const auto found = robots_.find(ruri);
  return found == robots_.end() ? 0 : found->second.held_since;
}

bool FakeDatabase::IsFenced(const storage::ProcessId& process, const storage::RobotRef& robot,
                            storage::Epoch held_since) {
  const Robot* const known = FindRobot(robot->ruri);
  if (known == nullptr || known->owner != process) return true;
  return !holds_by_owner_alone_ && held_since != known->held_since;
}

}  // namespace uplink::testing
