#include "server/view/foreign_parts.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "schema/base/check.h"
#include "server/robot/live_bytes.h"
#include "server/view/parts.h"

namespace uplink::view {
namespace {

using ByRuri = std::unordered_map<std::string_view, RobotView*>;

/// Those of the last look at all robots may be older.
void PutVersions(const std::vector<std::string>& foreign, const ForeignRead& read,
                 const ByRuri& robots) {
  for (std::size_t i = 0; i < read.live.complete; ++i) {
    const auto found = robots.find(foreign[i]);
    if (found == robots.end()) continue;
    found->second->glance.agent_version.clear();
    found->second->glance.software_version.clear();
  }
  for (const storage::LatestRow& row : read.infos) {
    const auto found = robots.find(row.ruri);
    if (found != robots.end()) FillVersions(row.body_json, found->second->glance);
  }
}

}  // namespace

std::vector<std::string> ForeignOf(const std::vector<RobotView>& robots) {
  std::vector<std::string> ruris;
  for (const RobotView& robot : robots) {
    if (robot.state.foreign) ruris.push_back(robot.id.ruri);
  }
  std::ranges::sort(ruris);
  return ruris;
}

std::size_t PutForeign(const std::vector<std::string>& foreign, const ForeignRead& read,
                       std::vector<RobotView>& robots) {
  const storage::Reader::LiveRows& live = read.live;
  UPLINK_CHECK(live.complete >= 1 && live.complete <= foreign.size(),
               "the store looks at one robot at least");
  ByRuri by_ruri;
  for (RobotView& robot : robots) {
    if (robot.state.foreign) by_ruri.emplace(robot.id.ruri, &robot);
  }
  PutVersions(foreign, read, by_ruri);
  schema::Judge judge(robot::JudgeLimitsOfLive());
  std::size_t complete = live.complete;
  std::size_t bytes = 0;
  for (const storage::LiveRow& row : live.rows) {
    const auto found = by_ruri.find(row.ruri);
    if (found == by_ruri.end()) continue;
    robot::LiveRead live_read = robot::FromRow(row, judge);
    robot::StateSnapshot& state = found->second->state;
    state.parts = std::move(live_read.before.parts);
    state.last_sign_of_life = live_read.before.last_sign_of_life;
    state.clock_skew_ms = live_read.before.clock_skew_ms;
    found->second->glance.vitals = VitalsOf({.parts = &state.parts});
    bytes += KeyedBytes(state.parts);
    if (bytes < storage::kPageBytesMax) continue;
    // Parsed parts take several times the bytes of their rows.
    const auto read_last = std::ranges::find(foreign, row.ruri);
    complete = std::min(complete, static_cast<std::size_t>(read_last - foreign.begin()) + 1);
    break;
  }
  if (complete == foreign.size()) return robots.size();
  const auto next = std::ranges::find_if(robots, [&](const RobotView& robot) {
    return robot.state.foreign && robot.id.ruri >= foreign[complete];
  });
  return static_cast<std::size_t>(next - robots.begin());
}

}  // namespace uplink::view
