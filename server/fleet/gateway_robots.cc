#include "server/fleet/gateway_robots.h"

namespace uplink::fleet {

bool GatewayRobots::Add(const std::string& ruri, const std::string& gateway) {
  const std::lock_guard lock(mutex_);
  if (counts_.Of(gateway) >= per_gateway_max_) return false;
  if (gateways_.emplace(ruri, gateway).second) counts_.Add(gateway);
  return true;
}

void GatewayRobots::Remove(const std::string& ruri) {
  const std::lock_guard lock(mutex_);
  const auto robot = gateways_.find(ruri);
  if (robot == gateways_.end()) return;
  counts_.Drop(robot->second);
  gateways_.erase(robot);
}

std::size_t GatewayRobots::of(const std::string& gateway) const {
  const std::lock_guard lock(mutex_);
  return counts_.Of(gateway);
}

}  // namespace uplink::fleet
