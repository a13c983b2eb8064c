#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "storage/live_parts.h"

namespace uplink::synthetic {

/// What is compared robot by robot; the order is that of the table.
enum class Thing : std::uint8_t {
  kOnline,
  kPresenceHistory,
// clang-format off
#define UPLINK_PART(Part, column, view, Message, keys_max) k##Part,
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
  // clang-format on
  kAgentInfo,
  kSettings,
  kUiCapabilities,
  kNumbersMissing,
  kFaultReports,
  kActiveFaults,
  kEvents,
  kMessages,
  kMissionRuns,
  kMissionUpdates,
  kShapes,
  kObjects,
  kQuarantine,
  kToldBeforeAck,
  kGaps,
  kGoodRejected,
  kForwardedItems,
  kForwardViolations,
  // Of twins, behind a broker.
  kTwinOnline,
  kTwinPresence,
  kTwinLive,
  kTwinSecrets,
  kTwinSessions,
  kTwinEvents,
  kTwinMessages,
  kTwinRuns,
  kTwinRunUpdates,
  kTwinFaults,
  kTwinActiveFaults,
  kTwinScopes,
  kTwinQuarantine,
};
inline constexpr std::size_t kThings = static_cast<std::size_t>(Thing::kTwinQuarantine) + 1;
/// The first one of twins; those before it are of robots on the relay.
inline constexpr std::size_t kTwinThings = static_cast<std::size_t>(Thing::kTwinOnline);

/// Differences that are kept in words.
inline constexpr std::size_t kDifferencesMax = 200;

/// How a thing is named in the table, and whether the server's state or the store says it.
struct ThingText {
  std::string_view name;
  bool of_store;
};
[[nodiscard]] ThingText TextOf(Thing thing);

/// One thing of one robot that is not as it must be. A value.
struct Difference {
  std::string ruri;
  Thing thing = Thing::kOnline;
  std::string expected;
  std::string found;
};

/// What the comparison of robots found, summed. Confined to one thread.
class Findings final {
 public:
  struct Tally {
    std::uint64_t expected = 0;
    std::uint64_t found = 0;
    std::uint64_t differences = 0;
  };

  void Expect(Thing thing, std::uint64_t count = 1) { At(thing).expected += count; }
  void Find(Thing thing, std::uint64_t count = 1) { At(thing).found += count; }
  void Differ(Thing thing, const std::string& ruri, std::string expected, std::string found);

  [[nodiscard]] const Tally& Of(Thing thing) const {
    return tallies_[static_cast<std::size_t>(thing)];
  }
  /// The first kDifferencesMax of them.
  [[nodiscard]] const std::vector<Difference>& differences() const { return differences_; }
  [[nodiscard]] std::uint64_t differences_in_all() const;

 private:
  Tally& At(Thing thing) { return tallies_[static_cast<std::size_t>(thing)]; }

  std::array<Tally, kThings> tallies_;
  std::vector<Difference> differences_;
};

}  // namespace uplink::synthetic
