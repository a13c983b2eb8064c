#include "server/view/queries.h"

#include <utility>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "server/identity/fleet_name.h"
#include "storage/fleets.h"
#include "storage/origin.h"

namespace uplink::view {

Queries::Queries(Sources sources)
    : sources_(std::move(sources)),
      started_at_(sources_.clock.System()),
      counts_({.reader = sources_.reader,
               .robots_max = sources_.fleet.robots_max(),
               .with_requests = sources_.drones != nullptr}),
      foreign_({sources_.clock, sources_.fleet, sources_.reader}),
      sorted_(sources_.fleet),
      brief_look_(sources_.to_store_thread) {}

std::optional<bool> Queries::IsOf(const std::string& ruri,
                                  const std::vector<std::string>& fleets) const {
  if (!fleets.empty() && storage::IsNoRobot(ruri)) return false;
  const fleet::RobotPtr robot = sources_.fleet.Find(ruri);
  if (robot == nullptr) return std::nullopt;
  return storage::LooksAt(fleets, robot->id()->fleet);
}

absl::StatusOr<QuarantineView> Queries::Quarantine(const storage::QuarantineQuery& query,
                                                   const std::vector<std::string>& fleets) {
  auto page = sources_.reader.Quarantine(query);
  if (!page.ok()) return page.status();
  if (query.rows.ruris.size() != 1) return QuarantineView{*std::move(page), {}};
  const std::string& ruri = query.rows.ruris.front();
  if (!fleets.empty() && !IsOf(ruri, fleets).value_or(false)) {
    return QuarantineView{*std::move(page), {}};
  }
  auto dropped = sources_.reader.QuarantineDropped(ruri);
  if (!dropped.ok()) return dropped.status();
  return QuarantineView{*std::move(page), *std::move(dropped)};
}

absl::StatusOr<StoryPage> Queries::Story(StoryQuery query) {
  const std::optional<bool> is_of = IsOf(query.ruri, query.fleets);
  const bool is_known = is_of.value_or(false);
  // The store may have rows of a fleet that the robot has left.
  if (!is_known && !query.fleets.empty() && RobotsAreUnread()) return Unknown(query.ruri);
  // The answer is that for a robot that was never there.
  if (is_of && !*is_of) query.fleets = {std::string(identity::kAllFleets)};
  absl::StatusOr<StoryPage> page = StoryOf(sources_.reader, query);
  const bool told_nothing = page.ok() && page->entries.empty() && query.page_token.empty();
  if (told_nothing && !is_known) return Unknown(query.ruri);
  return page;
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

bool Queries::RobotsAreUnread() const { return sources_.robots_unread && sources_.robots_unread(); }

absl::Status Queries::Unknown(const std::string& ruri) const {
  if (RobotsAreUnread()) {
    return absl::UnavailableError("the robots have not been read from the store yet");
  }
  return absl::NotFoundError(fmt::format("this server has no robot with the RURI {} now", ruri));
}

}  // namespace uplink::view
