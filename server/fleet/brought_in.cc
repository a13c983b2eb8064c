#include "server/fleet/brought_in.h"

namespace uplink::fleet {

bool BroughtIn::Add(const std::string& ruri, const std::string& gateway) {
  const std::lock_guard lock(mutex_);
  const auto found = counts_.find(gateway);
  if (found != counts_.end() && found->second >= per_gateway_max_) return false;
  if (gateways_.emplace(ruri, gateway).second) ++counts_[gateway];
  return true;
}

void BroughtIn::Remove(const std::string& ruri) {
  const std::lock_guard lock(mutex_);
  const auto robot = gateways_.find(ruri);
  if (robot == gateways_.end()) return;
  const auto gateway = counts_.find(robot->second);
  if (--gateway->second == 0) counts_.erase(gateway);
  gateways_.erase(robot);
}

std::size_t BroughtIn::of(const std::string& gateway) const {
  const std::lock_guard lock(mutex_);
  const auto found = counts_.find(gateway);
  return found == counts_.end() ? 0 : found->second;
}

}  // namespace uplink::fleet
