#include "server/view/foreign_glances.h"

#include <algorithm>
#include <utility>

#include "schema/json/text.h"
#include "server/robot/live_bytes.h"

namespace uplink::view {
namespace {

void AddLive(const storage::LiveRow& row, schema::Judge& judge, Glance& glance) {
  const robot::LiveBefore before = robot::FromRow(row, judge).before;
  glance.vitals = VitalsOf({.parts = &before.parts});
  glance.faulted = before.parts.status && before.parts.status->faulted;
  glance.last_heard = before.last_sign_of_life;
}

}  // namespace

std::vector<std::string> ForeignGlances::Foreign() const {
  std::vector<std::string> ruris;
  for (const fleet::RobotPtr& robot : context_.fleet.All()) {
    if (robot->state.foreign()) ruris.push_back(robot->ruri());
  }
  std::ranges::sort(ruris);
  return ruris;
}

bool ForeignGlances::due() const {
  const SteadyTime now = context_.clock.Steady();
  {
    const std::lock_guard lock(mutex_);
    if (read_at_ != SteadyTime() && now - read_at_ < kForeignEvery) return false;
  }
  return std::ranges::any_of(context_.fleet.All(),
                             [](const fleet::RobotPtr& robot) { return robot->state.foreign(); });
}

absl::Status ForeignGlances::Read() {
  const std::vector<std::string> ruris = Foreign();
  auto map = std::make_shared<Map>();
  for (std::span<const std::string> left = ruris; !left.empty();) {
    const auto read = ReadFirst(left.first(std::min(left.size(), kForeignAtOnce)), *map);
    if (!read.ok()) return read.status();
    left = left.subspan(*read);
  }
  const std::lock_guard lock(mutex_);
  glances_ = std::move(map);
  read_at_ = context_.clock.Steady();
  return absl::OkStatus();
}

absl::StatusOr<std::size_t> ForeignGlances::ReadFirst(std::span<const std::string> ruris,
                                                      Map& map) {
  const auto live = context_.reader.LiveOf(ruris);
  if (!live.ok()) return live.status();
  const auto infos = context_.reader.Latest(ruris.first(live->complete),
                                            storage::BitOf(storage::LatestKind::kAgentInfo));
  if (!infos.ok()) return infos.status();
  const std::size_t complete = std::clamp<std::size_t>(infos->complete, 1, live->complete);
  schema::Judge judge(robot::JudgeLimitsOfLive());
  for (const std::string& ruri : ruris.first(complete)) map[ruri];
  for (const storage::LiveRow& row : live->rows) {
    if (const auto at = map.find(row.ruri); at != map.end()) AddLive(row, judge, at->second);
  }
  for (const storage::LatestRow& row : infos->rows) {
    const auto at = map.find(row.ruri);
    if (at == map.end()) continue;
    at->second.agent_version = json::StringIn(row.body_json, "agentVersion").value_or("");
    at->second.software_version = json::StringIn(row.body_json, "softwareVersion").value_or("");
  }
  return complete;
}

std::shared_ptr<const ForeignGlances::Map> ForeignGlances::glances() const {
  const SteadyTime now = context_.clock.Steady();
  const std::lock_guard lock(mutex_);
  return now - read_at_ > kForeignAgeMax ? std::make_shared<const Map>() : glances_;
}

}  // namespace uplink::view
