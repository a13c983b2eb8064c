#include "server/view/queries.h"

#include <utility>

#include <absl/status/status.h>
#include <fmt/core.h>

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

absl::StatusOr<QuarantineView> Queries::Quarantine(const storage::QuarantineQuery& query) {
  auto page = sources_.reader.Quarantine(query);
  if (!page.ok()) return page.status();
  if (query.rows.ruris.size() != 1) return QuarantineView{*std::move(page), {}};
  auto dropped = sources_.reader.QuarantineDropped(query.rows.ruris.front());
  if (!dropped.ok()) return dropped.status();
  return QuarantineView{*std::move(page), *std::move(dropped)};
}

absl::StatusOr<StoryPage> Queries::Story(const StoryQuery& query) {
  absl::StatusOr<StoryPage> page = StoryOf(sources_.reader, query);
  const bool told_nothing = page.ok() && page->entries.empty() && query.page_token.empty();
  if (told_nothing && sources_.fleet.Find(query.ruri) == nullptr) return Unknown(query.ruri);
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

absl::Status Queries::Unknown(const std::string& ruri) const {
  if (sources_.robots_unread && sources_.robots_unread()) {
    return absl::UnavailableError("the robots have not been read from the store yet");
  }
  return absl::NotFoundError(fmt::format("this server has no robot with the RURI {} now", ruri));
}

}  // namespace uplink::view
