#include "server/view/queries.h"

#include <algorithm>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "schema/base/check.h"
#include "server/view/drone_json.h"
#include "server/view/foreign_parts.h"
#include "server/view/page_token.h"
#include "server/view/parts.h"
#include "server/view/twin_copy.h"

namespace uplink::view {
namespace {

RobotView Look(const robot::Robot& robot, robot::RobotState::Parts parts) {
  RobotView view{*robot.id(), robot.state.Snapshot(parts), robot.sessions.View(), 0, {}};
  if (!view.session.connected) {
    view.session.gateway = robot.calls.open() ? robot.speaker().value_or("") : "";
  }
  view.is_drone = robot.calls.spoke();
  for (std::size_t kind = 0; kind < metrics::kKinds; ++kind) {
    view.rate_limited[kind] = robot.rates.limited(kind);
  }
  return view;
}

robot::RobotState::Parts Wanted(const PartSet& parts) {
  using enum robot::RobotState::Parts;
  if (parts.AnyLarge()) return kAll;
  return parts.AnyLive() ? kSmall : kNone;
}

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

void SetStored(storage::LatestRow row, StoredParts& stored) {
  switch (row.kind) {
    case storage::LatestKind::kAgentInfo:
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
  page.next_token = RobotsToken(page.robots.back().id.ruri);
}

bool Matches(const robot::Robot& robot, const RobotsQuery& query) {
  if (storage::IsNoRobot(robot.ruri())) return false;
  if (query.presence && robot.state.presence() != *query.presence) return false;
  return query.fleet.empty() || robot.id()->fleet == query.fleet;
}

}  // namespace

Queries::Queries(Sources sources)
    : sources_(std::move(sources)),
      started_at_(sources_.clock.System()),
      counts_({.reader = sources_.reader,
               .robots_max = sources_.fleet.robots_max(),
               .with_requests = sources_.drones != nullptr}),
      brief_look_(sources_.to_store_thread) {}

/// One look into the store: the question, and the answer.
struct Queries::Lookup {
  std::vector<std::string> ruris;
  std::vector<std::string> foreign;
  absl::StatusOr<storage::Reader::LiveRows> live = absl::UnavailableError("not read");
};

absl::StatusOr<RobotsPage> Queries::Robots(const RobotsQuery& query) {
  std::string after;
  if (!query.page_token.empty()) {
    std::optional<std::string> ruri = RuriFromToken(query.page_token);
    if (!ruri) return absl::InvalidArgumentError("pageToken is not one that this list gave");
    after = std::move(*ruri);
  }
  RobotsPage page;
  std::size_t bytes = 0;
  for (const fleet::RobotPtr& robot : sources_.fleet.Sorted()) {
    if (!Matches(*robot, query)) continue;
    ++page.total;
    if (robot->ruri() <= after) continue;
    if (page.robots.size() < query.page_size && bytes < storage::kPageBytesMax) {
      page.robots.push_back(Look(*robot, Wanted(query.parts)));
      bytes += KeyedBytes(page.robots.back().state.parts);
      if (query.parts.Has(Part::kCyberwave)) {
        bytes += CopyTwin(sources_.twins, page.robots.back());
      }
      bytes += CopyDrone(sources_.drones, query.parts.Has(Part::kUncrew), page.robots.back());
    } else if (page.next_token.empty()) {
      page.next_token = RobotsToken(page.robots.back().id.ruri);
    }
  }
  if (!query.parts.AnyStored()) {
    FillBriefly(page, query.parts);
    return page;
  }
  if (query.parts.AnyLive()) {
    // While the store is away these robots come without live parts, so that the list shows the
    // others.
    const absl::StatusOr<std::size_t> live = FillForeign(page.robots);
    if (live.ok()) EndPageAfter(*live, page);
  }
  const absl::StatusOr<std::size_t> filled = FillStored(page.robots, query.parts);
  if (!filled.ok()) return filled.status();
  EndPageAfter(*filled, page);
  FillCounts(page.robots);
  return page;
}

absl::StatusOr<RobotView> Queries::Robot(const std::string& ruri) {
  const fleet::RobotPtr robot = sources_.fleet.Find(ruri);
  if (robot == nullptr || storage::IsNoRobot(ruri)) return Unknown(ruri);
  std::vector<RobotView> one;
  one.push_back(Look(*robot, robot::RobotState::Parts::kAll));
  CopyTwin(sources_.twins, one.front());
  CopyDrone(sources_.drones, true, one.front());
  // If the store is away, wait for it once and leave its parts out: the live ones must be shown.
  if (FillCounts(one)) {
    static_cast<void>(FillStored(one, PartSet::All()));
    static_cast<void>(FillForeign(one));
  }
  return std::move(one.front());
}

absl::StatusOr<QuarantineView> Queries::Quarantine(const storage::QuarantineQuery& query) {
  auto page = sources_.reader.Quarantine(query);
  if (!page.ok()) return page.status();
  if (query.rows.ruris.size() != 1) return QuarantineView{*std::move(page), {}};
  auto dropped = sources_.reader.QuarantineDropped(query.rows.ruris.front());
  if (!dropped.ok()) return dropped.status();
  return QuarantineView{*std::move(page), *std::move(dropped)};
}

absl::StatusOr<storage::Page<storage::ShapeRow>> Queries::Shapes(storage::PresentQuery query) {
  query.now = sources_.clock.System();
  return sources_.reader.Shapes(query);
}

absl::StatusOr<storage::Page<storage::ObjectRow>> Queries::Objects(storage::PresentQuery query) {
  query.now = sources_.clock.System();
  return sources_.reader.Objects(query);
}

StatusView Queries::Status() const {
  StatusView status;
  status.version = sources_.version;
  status.started_at = started_at_;
  status.now = sources_.clock.System();
  for (const fleet::RobotPtr& robot : sources_.fleet.Sorted()) {
    if (storage::IsNoRobot(robot->ruri())) continue;
    switch (robot->state.presence()) {
      case robot::Presence::kUnknown:
        ++status.robots.unknown;
        break;
      case robot::Presence::kOnline:
        ++status.robots.online;
        break;
      case robot::Presence::kOffline:
        ++status.robots.offline;
        break;
    }
  }
  status.streams = sources_.streams.value();
  for (const model::MessageSource source : model::kAllMessageSources) {
    status.messages[static_cast<std::size_t>(source)] = sources_.ledgers.Sum(source).messages;
  }
  status.journal_records = sources_.journals.records();
  status.journal_bytes = sources_.journals.bytes();
  status.journal_oldest = sources_.journals.oldest(sources_.clock.Steady());
  if (sources_.broker) status.broker = sources_.broker();
  return status;
}

absl::Status Queries::Unknown(const std::string& ruri) const {
  if (sources_.robots_unread && sources_.robots_unread()) {
    return absl::UnavailableError("the robots have not been read from the store yet");
  }
  return absl::NotFoundError(fmt::format("this server has no robot with the RURI {} now", ruri));
}

void Queries::FillBriefly(RobotsPage& page, const PartSet& parts) {
  if (page.robots.empty()) return;
  auto look = std::make_shared<Lookup>();
  look->ruris = RurisOf(page.robots);
  if (parts.AnyLive()) look->foreign = ForeignOf(page.robots);
  const bool in_time = brief_look_.Run([this, look] {
    static_cast<void>(counts_.Read(look->ruris));
    if (!look->foreign.empty()) look->live = sources_.reader.LiveOf(look->foreign);
  });
  // A late look may still be writing its answer: do not read that.
  if (in_time && look->live.ok()) {
    EndPageAfter(PutForeign(look->foreign, *look->live, page.robots), page);
  }
  counts_.Fill(page.robots);
}

absl::StatusOr<std::size_t> Queries::FillForeign(std::vector<RobotView>& robots) {
  const std::vector<std::string> foreign = ForeignOf(robots);
  if (foreign.empty()) return robots.size();
  const auto live = sources_.reader.LiveOf(foreign);
  if (!live.ok()) return live.status();
  return PutForeign(foreign, *live, robots);
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
  std::unordered_map<std::string_view, StoredParts*> by_ruri;
  for (RobotView& robot : robots) by_ruri.emplace(robot.id.ruri, &robot.stored);
  for (storage::LatestRow& row : latest->rows) {
    const auto robot = by_ruri.find(row.ruri);
    if (robot != by_ruri.end()) SetStored(std::move(row), *robot->second);
  }
  return latest->complete;
}

}  // namespace uplink::view
