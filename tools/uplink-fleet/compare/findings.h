#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "storage/live_parts.h"

/// What is compared of each robot, in the order of the table: THING(Name, text, of_store) and a
/// PART (storage/live_parts.h) for each live part. `of_store`: the store says it, not the server's
/// state. Those from TwinOnline on are of twins behind a broker, those from DroneOnline on of
/// drones.
#define UPLINK_THINGS(THING, PART)                                     \
  THING(Online, "robots online", false)                                \
  THING(PresenceHistory, "presence histories", true)                   \
  UPLINK_LIVE_PARTS(PART)                                              \
  THING(AgentInfo, "latest agent info", true)                          \
  THING(Settings, "latest settings", true)                             \
  THING(UiCapabilities, "latest UI capabilities", true)                \
  THING(NumbersMissing, "numbers missing", false)                      \
  THING(FaultReports, "fault reports", true)                           \
  THING(ActiveFaults, "active faults", true)                           \
  THING(Events, "events", true)                                        \
  THING(Messages, "messages for people", true)                         \
  THING(MissionRuns, "mission runs", true)                             \
  THING(MissionUpdates, "mission updates", true)                       \
  THING(Shapes, "shapes present", true)                                \
  THING(Objects, "objects present", true)                              \
  THING(Quarantine, "wrong on purpose, in quarantine", true)           \
  THING(ToldBeforeAck, "wrong on purpose, told before the ack", false) \
  THING(Gaps, "gaps", true)                                            \
  THING(GoodRejected, "good messages rejected", false)                 \
  THING(ForwardedItems, "forwarded items", false)                      \
  THING(ForwardViolations, "forward violations", false)                \
  THING(Parked, "robots parked", false)                                \
  THING(TwinOnline, "twins' robots online, by source", false)          \
  THING(TwinPresence, "presence histories", true)                      \
  THING(TwinLive, "last live values", false)                           \
  THING(TwinSecrets, "answers without a secret", false)                \
  THING(TwinSessions, "sessions", false)                               \
  THING(TwinEvents, "events", true)                                    \
  THING(TwinMessages, "log lines", true)                               \
  THING(TwinRuns, "mission runs", true)                                \
  THING(TwinRunUpdates, "mission updates", true)                       \
  THING(TwinFaults, "errors raised and cleared", true)                 \
  THING(TwinActiveFaults, "active errors", true)                       \
  THING(TwinScopes, "environments and workflow runs", true)            \
  THING(TwinQuarantine, "wrong on purpose, in quarantine", true)       \
  THING(DroneOnline, "drones online, by source", false)                \
  THING(DronePresence, "presence histories", true)                     \
  THING(DroneLive, "last live values", false)                          \
  THING(DroneAnswers, "drones whose answers were all due", false)      \
  THING(DroneMessages, "status texts", true)                           \
  THING(DroneEvents, "events", true)                                   \
  THING(DroneFaults, "alerts raised and cleared", true)                \
  THING(DroneActiveFaults, "active alerts", true)                      \
  THING(DroneRequests, "operator requests, open or closed", true)      \
  THING(DroneRequestsOpen, "drones' counts of open requests", false)   \
  THING(DroneQuarantine, "wrong on purpose, in quarantine", true)

namespace uplink::synthetic {

enum class Thing : std::uint8_t {
#define UPLINK_THING(Name, text, of_store) k##Name,
#define UPLINK_PART(Part, column, view, Message, keys_max) k##Part,
  UPLINK_THINGS(UPLINK_THING, UPLINK_PART)
#undef UPLINK_PART
#undef UPLINK_THING
};

inline constexpr std::size_t kThings = static_cast<std::size_t>(Thing::kDroneQuarantine) + 1;
/// The first one of twins; those before it are of robots on the relay.
inline constexpr std::size_t kTwinThings = static_cast<std::size_t>(Thing::kTwinOnline);
/// The first one of drones.
inline constexpr std::size_t kDroneThings = static_cast<std::size_t>(Thing::kDroneOnline);

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
  /// One that is expected, and found if it is `right`.
  void Check(Thing thing, const std::string& ruri, bool right, std::string expected,
             std::string found);

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
