#include "server/view/story_entries.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "schema/base/utf8.h"
#include "schema/model/connection.h"
#include "schema/model/enum_text.h"
#include "schema/model/presence.h"
#include "schema/model/rejection.h"
#include "server/view/messages.h"

namespace uplink::view {
namespace {

namespace json = boost::json;

/// Bytes of a text of the robot, or of a connection, within a title.
constexpr std::size_t kTitleTextMax = 256;

/// Fit for a terminal.
std::string Shown(std::string_view text) { return PrintableUtf8(text, kTitleTextMax); }

std::string TitleOf(const storage::PresenceRow& row) {
  switch (row.presence) {
    case model::Presence::kOnline:
      return "The robot is online.";
    case model::Presence::kOffline:
      return row.why ? fmt::format("The robot is offline: its last connection ended as {}.",
                                   model::ToText(*row.why))
                     : "The robot is offline: nothing was heard of it.";
    case model::Presence::kUnknown:
      break;
  }
  return "Whether the robot is online is unknown.";
}

std::string TitleOf(const storage::FaultRow& row) {
  const model::Fault& fault = row.fault;
  const std::string id = Shown(fault.fault_id);
  if (!fault.active) return fmt::format("Fault {} was cleared.", id);
  const std::string severity = model::EnumText(fault.severity);
  if (fault.description.empty()) return fmt::format("Fault {} was raised ({}).", id, severity);
  return fmt::format("Fault {} was raised ({}): {}", id, severity, Shown(fault.description));
}

std::string TitleOf(const storage::MissionRunRow& row) {
  const std::string& name = row.name.empty() ? row.mission_id : row.name;
  return fmt::format("Mission {} began; by its last report it is {}.", Shown(name),
                     model::EnumText(row.status));
}

std::string TitleOf(const RejectGroup& group) {
  const std::string_view reason = model::ToText(group.first.rejection.reason);
  if (group.count == 1) return fmt::format("A message was rejected: {}.", reason);
  return fmt::format("{} messages were rejected: {}.", group.count, reason);
}

std::string BeginTitle(const storage::ConnectionRow& row) {
  std::string title = fmt::format("The robot connected from {}", Shown(row.address));
  if (!row.gateway.empty()) title += fmt::format(" through gateway {}", Shown(row.gateway));
  return title + ".";
}

std::string EndTitle(const storage::ConnectionRow& row) {
  const model::ConnectionEnd why = row.why.value_or(model::ConnectionEnd::kBroken);
  std::string title =
      fmt::format("The connection from {} ended: {}", Shown(row.address), model::ToText(why));
  if (!row.detail.empty()) title += fmt::format(" ({})", Shown(row.detail));
  return title + ".";
}

std::string HeldBackTitle(const storage::ConnectionRow& row) {
  const std::chrono::duration<double> seconds = milliseconds(row.held_back_ms);
  return fmt::format("The server had held the stream back for {:.1f} s in all, last for {}.",
                     seconds.count(), row.held_back_why);
}

}  // namespace

absl::StatusOr<StoryEntry> StoryEntries::Of(const StoryPlace& place,
                                            const storage::PresenceRow& row) const {
  json::object detail{{"presence", model::ToText(row.presence)}};
  if (row.why) detail["why"] = model::ToText(*row.why);
  return StoryEntry{place, TitleOf(row), json::serialize(detail)};
}

absl::StatusOr<StoryEntry> StoryEntries::Of(const StoryPlace& place,
                                            const storage::FaultRow& row) const {
  absl::StatusOr<std::string> detail = printer_.Print(ToMessage(row));
  if (!detail.ok()) return detail.status();
  return StoryEntry{place, TitleOf(row), *std::move(detail)};
}

absl::StatusOr<StoryEntry> StoryEntries::Of(const StoryPlace& place,
                                            const storage::MissionRunRow& row) const {
  absl::StatusOr<std::string> detail = printer_.Print(ToMessage(row));
  if (!detail.ok()) return detail.status();
  return StoryEntry{place, TitleOf(row), *std::move(detail)};
}

absl::StatusOr<StoryEntry> StoryEntries::Of(const RejectGroup& group) const {
  const storage::QuarantineRow& row = group.first;
  const json::object detail{{"reason", model::ToText(row.rejection.reason)},
                            {"count", std::uint64_t{group.count}},
                            {"firstAt", Rfc3339(group.earliest)},
                            {"lastAt", Rfc3339(group.latest)},
                            {"seq", std::to_string(row.seq)},
                            {"field", row.rejection.field},
                            {"detail", row.rejection.detail}};
  return StoryEntry{group.place, TitleOf(group), json::serialize(detail)};
}

absl::StatusOr<std::vector<StoryEntry>> StoryEntries::Of(
    const storage::Page<storage::ConnectionRow>& page) const {
  std::vector<StoryEntry> entries;
  for (std::size_t i = 0; i < page.rows.size(); ++i) {
    const storage::ConnectionRow& row = page.rows[i];
    const std::uint64_t number = page.positions[i].entry;
    const absl::StatusOr<std::string> detail = printer_.Print(ToMessage(row));
    if (!detail.ok()) return detail.status();
    entries.push_back({{row.began_at, StoryKind::kConnected, number}, BeginTitle(row), *detail});
    const std::string* const before =
        i + 1 < page.rows.size() ? &page.rows[i + 1].robot.fleet : nullptr;
    if (before != nullptr && *before != row.robot.fleet) {
      entries.push_back(
          {{row.began_at, StoryKind::kFleetMoved, number},
           fmt::format("The robot moved from fleet {} to fleet {}.", Shown(*before),
                       Shown(row.robot.fleet)),
           json::serialize(json::object{{"from", *before}, {"to", row.robot.fleet}})});
    }
    if (!row.ended_at) continue;
    if (row.held_back_ms > 0) {
      entries.push_back(
          {{*row.ended_at, StoryKind::kHeldBack, number}, HeldBackTitle(row), *detail});
    }
    entries.push_back({{*row.ended_at, StoryKind::kDisconnected, number}, EndTitle(row), *detail});
  }
  return entries;
}

}  // namespace uplink::view
