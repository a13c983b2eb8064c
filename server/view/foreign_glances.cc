#include "server/view/foreign_glances.h"

#include <algorithm>
#include <span>
#include <utility>

#include "server/robot/live_bytes.h"

namespace uplink::view {
namespace {

void AddLive(const storage::LiveRow& row, schema::Judge& judge, Glance& glance) {
  const robot::LiveBefore before = robot::FromRow(row, judge).before;
  glance.vitals = VitalsOf({.parts = &before.parts});
  glance.faulted = before.parts.status && before.parts.status->faulted;
  glance.last_heard = before.last_sign_of_life;
}

/// These robots were looked at. What the store does not have of one stays empty, but a status that
/// is not there says no fault.
void Put(std::span<const std::string> ruris, const ForeignRead& read, GlanceMap& glances) {
  for (const std::string& ruri : ruris) glances[ruri].faulted = false;
  schema::Judge judge(robot::JudgeLimitsOfLive());
  for (const storage::LiveRow& row : read.live.rows) {
    if (const auto at = glances.find(row.ruri); at != glances.end())
      AddLive(row, judge, at->second);
  }
  for (const storage::LatestRow& row : read.infos) {
    if (const auto at = glances.find(row.ruri); at != glances.end()) {
      FillVersions(row.body_json, at->second);
    }
  }
}

}  // namespace

absl::StatusOr<ForeignRead> ReadForeign(storage::Reader& reader,
                                        std::span<const std::string> ruris) {
  auto live = reader.LiveOf(ruris);
  if (!live.ok()) return live.status();
  auto infos =
      reader.Latest(ruris.first(live->complete), storage::BitOf(storage::LatestKind::kAgentInfo));
  if (!infos.ok()) return infos.status();
  live->complete = std::clamp<std::size_t>(infos->complete, 1, live->complete);
  return ForeignRead{.live = *std::move(live), .infos = std::move(infos->rows)};
}

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
  auto map = std::make_shared<GlanceMap>();
  for (std::span<const std::string> left = ruris; !left.empty();) {
    const std::span<const std::string> first = left.first(std::min(left.size(), kForeignAtOnce));
    const absl::StatusOr<ForeignRead> read = ReadForeign(context_.reader, first);
    if (!read.ok()) return read.status();
    Put(first.first(read->live.complete), *read, *map);
    left = left.subspan(read->live.complete);
  }
  const std::lock_guard lock(mutex_);
  glances_ = std::move(map);
  read_at_ = context_.clock.Steady();
  return absl::OkStatus();
}

std::shared_ptr<const GlanceMap> ForeignGlances::glances() const {
  const SteadyTime now = context_.clock.Steady();
  const std::lock_guard lock(mutex_);
  return now - read_at_ > kForeignAgeMax ? std::make_shared<const GlanceMap>() : glances_;
}

}  // namespace uplink::view
