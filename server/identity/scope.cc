#include "server/identity/scope.h"

#include <algorithm>
#include <functional>

#include "server/identity/fleet_name.h"

namespace uplink::identity {

Scope Scope::Of(std::vector<std::string> fleets) {
  std::ranges::sort(fleets);
  fleets.erase(std::unique(fleets.begin(), fleets.end()), fleets.end());
  return {std::move(fleets), false};
}

bool Scope::Has(std::string_view fleet) const {
  return all_ || std::ranges::binary_search(fleets_, fleet, std::less<>());
}

std::vector<std::string> Scope::Restrict(const std::string& fleet) const {
  if (!fleet.empty()) return {Has(fleet) ? fleet : std::string(kAllFleets)};
  if (all_) return {};
  return fleets_.empty() ? std::vector<std::string>{std::string(kAllFleets)} : fleets_;
}

}  // namespace uplink::identity
