#include "server/rcan/robot_info.h"

#include <array>

namespace uplink::rcan {
namespace {

using enum metrics::rcan::SeriesId;

bool Admits(const RobotInfo& info, SeriesNames& names, const NameRules& rules, SteadyTime now) {
  if (info.software_version.empty() && info.agent_version.empty()) return true;
  SeriesNames::Limits limits = rules.limits;
  limits.names_max = kInfosMax;
  std::string both(info.software_version);
  both.push_back('\0');
  both.append(info.agent_version);
  names.BeginScrape(now);
  return names.Admit(rules.hash(both), 1, limits).shown != 0;
}

}  // namespace

std::string_view NameOf(std::string_view ruri) {
  while (ruri.ends_with('/')) ruri.remove_suffix(1);
  // npos + 1 is the whole.
  return ruri.substr(ruri.rfind('/') + 1);
}

void AddInfo(const RobotInfo& info, SeriesNames& names, const NameRules& rules, SteadyTime now,
             metrics::rcan::SeriesPage& page) {
  if (!page.Writes(kInfo)) return;
  const bool admits = Admits(info, names, rules, now);
  const std::array<std::string_view, 4> labels = {info.fleet, NameOf(info.ruri),
                                                  admits ? info.software_version : "",
                                                  admits ? info.agent_version : ""};
  page.Add(kInfo, labels, 1);
}

}  // namespace uplink::rcan
