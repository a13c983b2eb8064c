#include "server/fleet/forgetting.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace uplink::fleet {

void Forgetting::Round() {
  RemoveLeft();
  ForgetSilent();
  NameRoom();
  for (const RobotPtr& robot : context_.fleet.Leaving()) context_.release(*robot);
}

void Forgetting::RemoveLeft() {
  const std::vector<RobotPtr> left = context_.fleet.RemoveLeft();
  if (left.empty()) return;
  context_.logger.Info("robots_forgotten",
                       {{"robots", left.size()}, {"first", left.front()->ruri()}});
}

void Forgetting::ForgetSilent() {
  if (!looks_.Take(context_.clock.Steady(), kForgetEvery)) return;
  for (const RobotPtr& robot : context_.fleet.All()) {
    if (!IsForgotten(robot->heard_at()) || robot->leaving() || !robot->idle()) continue;
    context_.fleet.BeginLeaving(*robot);
  }
}

bool Forgetting::IsForgotten(SystemTime heard_at) const {
  if (context_.forget_after.count() == 0 || !context_.clock_vouched()) return false;
  return context_.clock.System() - heard_at > context_.forget_after;
}

void Forgetting::NameRoom() {
  if (context_.fleet.size() * 100 < context_.fleet.robots_max() * kRoomPercent) return;
  std::vector<std::pair<SystemTime, RobotPtr>> idle;
  for (RobotPtr& robot : context_.fleet.All()) {
    if (!robot->leaving() && robot->idle()) idle.emplace_back(robot->heard_at(), std::move(robot));
  }
  const auto end = idle.begin() + static_cast<std::ptrdiff_t>(std::min(idle.size(), kRoomMax));
  std::ranges::partial_sort(idle, end, {}, &std::pair<SystemTime, RobotPtr>::first);
  std::vector<std::weak_ptr<robot::Robot>> room;
  for (auto robot = end; robot != idle.begin();) room.emplace_back((--robot)->second);
  context_.fleet.SetRoom(std::move(room));
}

}  // namespace uplink::fleet
