#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/reader.h"

namespace uplink::view {

/// What an entry of a robot's story tells, and its place among entries of one time. The numbers are
/// part of the tokens that readers hold.
enum class StoryKind : std::uint8_t {
  kConnected = 0,
  /// A connection came with a certificate of another fleet than the one before.
  kFleetMoved = 1,
  kPresence = 2,
  kMission = 3,
  kFault = 4,
  /// Rejected messages of one reason, between two other entries.
  kRejected = 5,
  kHeldBack = 6,
  kDisconnected = 7,
};
inline constexpr std::size_t kStoryKinds = 8;

/// As StoryEntry.kind in fleet.proto.
[[nodiscard]] std::string_view ToText(StoryKind kind);

/// Where an entry stands. `entry` is the number of its row in the store: no two have one place.
struct StoryPlace {
  SystemTime at;
  StoryKind kind = StoryKind::kConnected;
  std::uint64_t entry = 0;

  friend auto operator<=>(const StoryPlace&, const StoryPlace&) = default;
};

struct StoryEntry {
  StoryPlace place;
  std::string title;
  /// The JSON text of an object.
  std::string detail_json;
};

struct StoryQuery {
  std::string ruri;
  /// Only rows of these; none: of any.
  std::vector<std::string> fleets{};
  /// Both inclusive.
  std::optional<SystemTime> from{};
  std::optional<SystemTime> to{};
  storage::ListOrder order = storage::ListOrder::kNewestFirst;
  /// 1 to storage::kPageSizeMax.
  std::uint32_t page_size = storage::kPageSizeDefault;
  std::string page_token{};
};

struct StoryPage {
  std::vector<StoryEntry> entries;
  /// Empty when this page is the last.
  std::string next_token;
};

/// Rejected messages that one page tells of; it ends early after them.
inline constexpr std::size_t kStoryRejectsMax = 1'000;

/// A page of a robot's story, merged from the store's lists: its connections' begins and ends, what
/// held it back, moves to other fleets, presence, faults, mission runs at their first report, and
/// rejected messages by reason. A walk tells each row that was there when it began exactly once.
///
/// Errors:  kInvalidArgument for a token that is none of ours; those of the Reader.
/// Thread:  the caller's; it waits for the store.
[[nodiscard]] absl::StatusOr<StoryPage> StoryOf(storage::Reader& reader, const StoryQuery& query);

}  // namespace uplink::view
