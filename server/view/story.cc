#include "server/view/story.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include <absl/status/status.h>

#include "server/view/story_entries.h"
#include "server/view/story_rows.h"
#include "server/view/story_token.h"

namespace uplink::view {
namespace {

using storage::PageKind;
using storage::Reader;

/// The entries of a robot's connections, which are so few that each page reads them all.
class ConnectionEntries final {
 public:
  [[nodiscard]] static absl::StatusOr<ConnectionEntries> Read(
      Reader& reader, const StoryEntries& entries, const StoryQuery& story,
      const std::optional<StoryPlace>& after) {
    static_assert(storage::kConnectionsPerRobotMax <= storage::kPageSizeMax);
    const auto page = reader.Connections(
        {.rows = {
             .ruris = {story.ruri}, .fleets = story.fleets, .page_size = storage::kPageSizeMax}});
    if (!page.ok()) return page.status();
    absl::StatusOr<std::vector<StoryEntry>> all = entries.Of(*page);
    if (!all.ok()) return all.status();
    const bool newest = story.order == storage::ListOrder::kNewestFirst;
    const auto comes_before = [newest](const StoryPlace& a, const StoryPlace& b) {
      return newest ? a > b : a < b;
    };
    std::erase_if(*all, [&](const StoryEntry& entry) {
      const SystemTime at = entry.place.at;
      return (story.from && at < *story.from) || (story.to && at > *story.to) ||
             (after && !comes_before(*after, entry.place));
    });
    std::ranges::sort(*all, comes_before, &StoryEntry::place);
    return ConnectionEntries(*std::move(all));
  }

  [[nodiscard]] static absl::Status Fill() { return absl::OkStatus(); }
  [[nodiscard]] std::optional<StoryPlace> place() const {
    if (next_ >= entries_.size()) return std::nullopt;
    return entries_[next_].place;
  }
  [[nodiscard]] StoryEntry Take() { return std::move(entries_[next_++]); }

 private:
  explicit ConnectionEntries(std::vector<StoryEntry> entries) : entries_(std::move(entries)) {}

  std::vector<StoryEntry> entries_;
  std::size_t next_ = 0;
};

using PresenceRows = StoryRows<storage::PresenceRow, storage::HistoryQuery, StoryKind::kPresence,
                               PageKind::kPresenceChanges>;
using FaultRows =
    StoryRows<storage::FaultRow, storage::FaultsQuery, StoryKind::kFault, PageKind::kFaultHistory>;
using MissionRows = StoryRows<storage::MissionRunRow, storage::MissionsQuery, StoryKind::kMission,
                              PageKind::kMissionRuns>;
using RejectRows = StoryRows<storage::QuarantineRow, storage::QuarantineQuery, StoryKind::kRejected,
                             PageKind::kQuarantine>;

/// A page in the making. Confined to one thread.
class PageWriter final {
 public:
  PageWriter(const StoryEntries& entries, const StoryQuery& story)
      : entries_(entries), story_(story) {}

  [[nodiscard]] bool full() const {
    return page_.entries.size() >= story_.page_size || rejects_ >= kStoryRejectsMax;
  }
  /// What follows these rows is for the next page.
  void EndHere() { page_.next_token = StoryToken(story_.order, last_); }

  [[nodiscard]] absl::Status Add(const StoryPlace& place, StoryEntry entry) {
    last_ = place;
    // What was rejected after this is another entry.
    if (absl::Status told = TellRejects(); !told.ok()) return told;
    page_.entries.push_back(std::move(entry));
    return absl::OkStatus();
  }
  template <typename Row>
  [[nodiscard]] absl::Status Add(const StoryPlace& place, const Row& row) {
    absl::StatusOr<StoryEntry> entry = entries_.Of(place, row);
    if (!entry.ok()) return entry.status();
    return Add(place, *std::move(entry));
  }
  [[nodiscard]] absl::Status Add(const StoryPlace& place, storage::QuarantineRow row) {
    last_ = place;
    ++rejects_;
    const SystemTime at = row.received_at;
    const auto known = std::ranges::find(groups_, row.rejection.reason, [](const Open& open) {
      return open.group.first.rejection.reason;
    });
    if (known == groups_.end()) {
      groups_.push_back({{place, std::move(row), 1, at, at}, page_.entries.size()});
      // Its place; what it tells is known once it is over.
      page_.entries.push_back({place, {}, {}});
      return absl::OkStatus();
    }
    RejectGroup& group = known->group;
    ++group.count;
    group.earliest = std::min(group.earliest, at);
    group.latest = std::max(group.latest, at);
    return absl::OkStatus();
  }

  [[nodiscard]] absl::StatusOr<StoryPage> Take() {
    if (absl::Status told = TellRejects(); !told.ok()) return told;
    return std::move(page_);
  }

 private:
  struct Open {
    RejectGroup group;
    /// Its place in the page.
    std::size_t entry = 0;
  };

  [[nodiscard]] absl::Status TellRejects() {
    for (const Open& open : groups_) {
      absl::StatusOr<StoryEntry> entry = entries_.Of(open.group);
      if (!entry.ok()) return entry.status();
      page_.entries[open.entry] = *std::move(entry);
    }
    groups_.clear();
    return absl::OkStatus();
  }

  const StoryEntries& entries_;
  const StoryQuery& story_;
  StoryPage page_;
  StoryPlace last_;
  std::size_t rejects_ = 0;
  std::vector<Open> groups_;
};

/// Merges what the sources have next into a page.
template <typename... Sources>
absl::StatusOr<StoryPage> Merge(PageWriter& page, const StoryQuery& story,
                                std::tuple<Sources...>& sources) {
  const bool newest = story.order == storage::ListOrder::kNewestFirst;
  while (true) {
    std::optional<StoryPlace> next;
    absl::Status status;
    const auto look = [&](auto& source) {
      status.Update(source.Fill());
      const std::optional<StoryPlace> place = source.place();
      if (!place) return;
      if (!next || (newest ? *place > *next : *place < *next)) next = place;
    };
    std::apply([&](auto&... each) { (look(each), ...); }, sources);
    if (!status.ok()) return status;
    if (!next) break;
    if (page.full()) {
      page.EndHere();
      break;
    }
    const auto take = [&](auto& source) {
      if (source.place() == next) status.Update(page.Add(*next, source.Take()));
    };
    std::apply([&](auto&... each) { (take(each), ...); }, sources);
    if (!status.ok()) return status;
  }
  return page.Take();
}

}  // namespace

std::string_view ToText(StoryKind kind) {
  switch (kind) {
    case StoryKind::kConnected:
      return "connected";
    case StoryKind::kFleetMoved:
      return "fleet_moved";
    case StoryKind::kPresence:
      return "presence";
    case StoryKind::kMission:
      return "mission";
    case StoryKind::kFault:
      return "fault";
    case StoryKind::kRejected:
      return "rejected";
    case StoryKind::kHeldBack:
      return "held_back";
    case StoryKind::kDisconnected:
      return "disconnected";
  }
  return "";
}

absl::StatusOr<StoryPage> StoryOf(Reader& reader, const StoryQuery& query) {
  std::optional<StoryPlace> after;
  if (!query.page_token.empty()) {
    const absl::StatusOr<StoryPlace> place = PlaceFromToken(query.order, query.page_token);
    if (!place.ok()) return place.status();
    after = *place;
  }
  const StoryEntries entries;
  absl::StatusOr<ConnectionEntries> connections =
      ConnectionEntries::Read(reader, entries, query, after);
  if (!connections.ok()) return connections.status();
  std::tuple sources(*std::move(connections),
                     PresenceRows(reader, &Reader::PresenceChanges, query, after),
                     FaultRows(reader, &Reader::FaultHistory, query, after),
                     MissionRows(reader, &Reader::MissionRuns, query, after),
                     RejectRows(reader, &Reader::Quarantine, query, after));
  PageWriter page(entries, query);
  return Merge(page, query, sources);
}

}  // namespace uplink::view
