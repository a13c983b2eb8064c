// What the store adds to robots: counts, stored parts, and the parts of robots that others hold.
#include <algorithm>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "schema/base/check.h"
#include "server/view/foreign_parts.h"
#include "server/view/queries.h"

namespace uplink::view {
namespace {

std::vector<std::string> RurisOf(const std::vector<RobotView>& robots) {
  std::vector<std::string> ruris;
  ruris.reserve(robots.size());
  for (const RobotView& robot : robots) ruris.push_back(robot.id.ruri);
  return ruris;
}

/// The latest rows that the wanted parts need.
storage::LatestKindSet KindsOf(const PartSet& parts) {
  using enum storage::LatestKind;
  storage::LatestKindSet kinds = 0;
  if (parts.Has(Part::kAgentInfo)) kinds |= BitOf(kAgentInfo);
  if (parts.Has(Part::kSettings)) kinds |= BitOf(kSettings);
  if (parts.Has(Part::kUiCapabilities)) kinds |= BitOf(kUiCapabilities);
  return kinds;
}

void SetStored(storage::LatestRow row, RobotView& robot) {
  StoredParts& stored = robot.stored;
  switch (row.kind) {
    case storage::LatestKind::kAgentInfo:
      FillVersions(row.body_json, robot.glance);
      stored.agent_info = std::move(row.body_json);
      break;
    case storage::LatestKind::kSettings:
      stored.settings = std::move(row.body_json);
      break;
    case storage::LatestKind::kUiCapabilities:
      stored.ui_capabilities = std::move(row.body_json);
      break;
  }
}

/// Robots that could not be filled go to the next page.
void EndPageAfter(std::size_t robots, RobotsPage& page) {
  if (robots >= page.robots.size()) return;
  page.robots.resize(robots);
  page.next_token = page.robots.back().next_token;
}

}  // namespace

/// One look into the store: the question, and the answer.
struct Queries::Lookup {
  std::vector<std::string> ruris;
  std::vector<std::string> foreign;
  absl::StatusOr<ForeignRead> read = absl::UnavailableError("not read");
};

absl::Status Queries::FillPage(RobotsPage& page, const PartSet& parts) {
  if (!parts.AnyStored()) {
    FillBriefly(page);
    return absl::OkStatus();
  }
  // While the store is away robots of others come without live parts, so that the list shows the
  // rest.
  const absl::StatusOr<std::size_t> live = FillForeign(page.robots);
  if (live.ok()) {
    EndPageAfter(std::max<std::size_t>(*live, 1), page);
    if (*live == 0) static_cast<void>(FillForeign(page.robots));
  }
  const absl::StatusOr<std::size_t> filled = FillStored(page.robots, parts);
  if (!filled.ok()) return filled.status();
  EndPageAfter(*filled, page);
  FillCounts(page.robots);
  return absl::OkStatus();
}

void Queries::FillRobot(std::vector<RobotView>& one) {
  // If the store is away, wait for it once and leave its parts out: the live ones must be shown.
  if (!FillCounts(one)) return;
  static_cast<void>(FillStored(one, PartSet::All()));
  static_cast<void>(FillForeign(one));
}

void Queries::FillBriefly(RobotsPage& page) {
  if (page.robots.empty()) return;
  auto look = std::make_shared<Lookup>();
  look->ruris = RurisOf(page.robots);
  look->foreign = ForeignOf(page.robots);
  const bool in_time = brief_look_.Run([this, look] {
    static_cast<void>(counts_.Read(look->ruris));
    if (!look->foreign.empty()) look->read = ReadForeign(sources_.reader, look->foreign);
  });
  // A late look may still be writing its answer: do not read that.
  if (in_time && look->read.ok()) {
    const std::size_t complete = PutForeign(look->foreign, *look->read, page.robots);
    EndPageAfter(std::max<std::size_t>(complete, 1), page);
    if (complete == 0) return FillBriefly(page);
  }
  counts_.Fill(page.robots);
}

absl::StatusOr<std::size_t> Queries::FillForeign(std::vector<RobotView>& robots) const {
  const std::vector<std::string> foreign = ForeignOf(robots);
  if (foreign.empty()) return robots.size();
  const absl::StatusOr<ForeignRead> read = ReadForeign(sources_.reader, foreign);
  if (!read.ok()) return read.status();
  return PutForeign(foreign, *read, robots);
}

bool Queries::FillCounts(std::vector<RobotView>& robots) {
  const bool read = robots.empty() || counts_.Read(RurisOf(robots));
  counts_.Fill(robots);
  return read;
}

absl::StatusOr<std::size_t> Queries::FillStored(std::vector<RobotView>& robots,
                                                const PartSet& parts) {
  const storage::LatestKindSet kinds = KindsOf(parts);
  if (kinds == 0 || robots.empty()) return robots.size();
  auto latest = sources_.reader.Latest(RurisOf(robots), kinds);
  if (!latest.ok()) return latest.status();
  UPLINK_CHECK(latest->complete >= 1 && latest->complete <= robots.size(),
               "the store looks at one robot at least");
  std::unordered_map<std::string_view, RobotView*> by_ruri;
  for (RobotView& robot : robots) by_ruri.emplace(robot.id.ruri, &robot);
  for (storage::LatestRow& row : latest->rows) {
    const auto robot = by_ruri.find(row.ruri);
    if (robot != by_ruri.end()) SetStored(std::move(row), *robot->second);
  }
  return latest->complete;
}

}  // namespace uplink::view
