#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "metrics/cells.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/fleet/robot_settings.h"
#include "server/fleet/top_senders.h"
#include "server/journal/shards.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/robot_state.h"
#include "server/uncrew/drones.h"
#include "server/view/brief_look.h"
#include "server/view/broker_status.h"
#include "server/view/fault_counts.h"
#include "server/view/foreign_glances.h"
#include "server/view/glance.h"
#include "server/view/parts.h"
#include "server/view/robots_filter.h"
#include "server/view/robots_query.h"
#include "server/view/sorted_robots.h"
#include "server/view/stored_counts.h"
#include "server/view/story.h"
#include "storage/reader.h"

namespace uplink::view {

/// A robot's latest parts as the store has them, each the JSON text of an object. A value.
struct StoredParts {
  std::optional<std::string> agent_info;
  std::optional<std::string> settings;
  std::optional<std::string> ui_capabilities;
};

/// One robot as it is now. A value.
struct RobotView {
  model::RobotId id;
  robot::StateSnapshot state;
  robot::SessionView session;
  /// As last read from the store.
  std::int64_t active_faults = 0;
  StoredParts stored;
  /// Messages over their rate since the stream began, by kind.
  std::array<std::uint64_t, metrics::kKinds> rate_limited{};
  /// What its messages at a broker reported, copied at that moment. Null if it is not wanted, if
  /// this process has heard no twin of this RURI, or if another process holds the robot.
  std::shared_ptr<const cyberwave::TwinParts> twin{};
  /// A drone: it reports by calls, or did so before.
  bool is_drone = false;
  /// This process has its live samples.
  bool calls_here = false;
  /// From its calls to this process; for a drone that calls elsewhere, as last read from the store.
  std::size_t operator_requests_open = 0;
  /// What its calls reported, copied at that moment. Null if it is not wanted, if the drone does
  /// not call this process, or if another one holds the robot.
  std::shared_ptr<const uncrew::LiveSamples> drone{};
  /// As lists filter by it.
  Glance glance{};
  /// What operators set of it. Null: nothing.
  fleet::RobotSettingPtr set{};
  /// Of the page after the one that ends with it.
  std::string next_token{};
};

struct RobotsPage {
  /// May be fewer than the page's size where large parts are wanted: a page ends with the robot
  /// whose parts bring it to storage::kPageBytesMax.
  std::vector<RobotView> robots;
  /// Empty when this page is the last.
  std::string next_token;
  /// Robots that match, on all pages.
  std::int64_t total = 0;
  /// Robots of other processes that may match: the store has not told what the filter asks about.
  std::int64_t unjudged = 0;
};

/// Versions of one fleet that are named; the rest count as kOtherVersions.
inline constexpr std::size_t kVersionsMax = 20;
inline constexpr std::string_view kOtherVersions = "_other";

/// One fleet in figures. A value.
struct FleetView {
  std::string fleet;
  std::int64_t robots = 0;
  fleet::PresenceTally presence{};
  /// By FaultSeverity, the last of any other. Empty: unknown, since the store is away.
  std::optional<FaultCounts::BySeverity> active_faults{};
  /// Robots whose e-stop is engaged.
  std::int64_t estops = 0;
  /// Robots by version; one that did not tell any is in none.
  std::map<std::string, std::int64_t> agent_versions{};
  std::map<std::string, std::int64_t> software_versions{};
};

/// Which fleets, by name. A value.
struct FleetsQuery {
  /// None: all.
  std::vector<std::string> fleets{};
  std::uint32_t page_size = storage::kPageSizeDefault;
  std::string page_token{};
};

struct FleetsPage {
  std::vector<FleetView> fleets;
  /// Empty when this page is the last.
  std::string next_token;
};

/// Rows of quarantine. A value.
struct QuarantineView {
  storage::Page<storage::QuarantineRow> page;
  /// If one robot was asked for: how many of its rows were deleted to keep the bound.
  std::vector<storage::DroppedRow> dropped;
};

/// The server in figures. A value.
struct StatusView {
  std::string version;
  SystemTime started_at;
  SystemTime now;
  fleet::PresenceCounts robots;
  std::int64_t streams = 0;
  /// By model::MessageSource. The conservation law holds for each.
  std::array<metrics::MessageCounts, model::kAllMessageSources.size()> messages{};
  std::size_t journal_records = 0;
  std::size_t journal_bytes = 0;
  milliseconds journal_oldest{0};
  /// Empty if no broker is read.
  std::optional<BrokerStatus> broker{};
};

/// Everything that readers of the fleet ask, once, for every transport. The placeholders for rows
/// of no robot (storage/origin.h) are not robots and appear in no list of robots. Where a question
/// names fleets, the answer is that of a server without other robots; no fleets: all.
///
/// Errors:  kInvalidArgument naming the field first (`pageToken ...`); kNotFound for a robot that
///          is not in memory, kUnavailable instead while the store's robots are not read yet;
///          those of the Reader where rows are asked for. Queries for robots succeed
///          while the store is away too: active faults are then as last read, and a single
///          robot comes without its stored parts. A list that names a stored part fails then. One
///          that names none waits for the store for kBriefLookWait at most, and then goes on as
///          if the store were away.
/// Limits:  remembers two counts per robot, at most for twice as many as the fleet may have.
/// Thread:  thread-safe; all but Status wait for the store, so never on the thread that serves
///          probes. Outlives the store's thread.
class Queries final {
 public:
  struct Sources {
    const Clock& clock;
    fleet::Fleet& fleet;
    storage::Reader& reader;
    const journal::Shards& journals;
    const metrics::LedgerBook& ledgers;
    /// Streams that are open now.
    const metrics::Cell& streams;
    std::string version;
    /// Posts to the thread that may wait for the store; empty: callers wait themselves.
    BriefLook::Post to_store_thread{};
    /// True while the store's robots are not in memory yet; empty: they are.
    std::function<bool()> robots_unread{};
    /// The twins of a broker; null: no broker is read.
    const cyberwave::Twins* twins = nullptr;
    /// Never waits, and may be called on any thread; empty: no broker is read.
    std::function<std::optional<BrokerStatus>()> broker{};
    /// The drones that call; null: none do.
    const uncrew::Drones* drones = nullptr;
    /// The active faults of all robots; null: unknown.
    FaultCounts* faults = nullptr;
    /// Null: no robot is named.
    fleet::TopSenders* top = nullptr;
    /// What operators set of robots; null: nothing.
    const fleet::RobotSettings* settings = nullptr;
  };
  explicit Queries(Sources sources);

  [[nodiscard]] absl::StatusOr<RobotsPage> Robots(const RobotsQuery& query);
  /// Never waits for long, and succeeds while the store is away.
  [[nodiscard]] absl::StatusOr<FleetsPage> Fleets(const FleetsQuery& query);
  /// The robots that send most to this process. Never waits.
  [[nodiscard]] std::vector<fleet::TopSenders::Sender> Top(
      fleet::TopBy by, std::size_t count, const std::vector<std::string>& fleets) const;
  /// With all parts.
  [[nodiscard]] absl::StatusOr<RobotView> Robot(const std::string& ruri,
                                                const std::vector<std::string>& fleets);
  /// A list of storage::Reader, such as `&storage::Reader::Events`: of all robots or of those that
  /// match, also of ones that are not in memory.
  template <typename Row, typename Query>
  [[nodiscard]] absl::StatusOr<storage::Page<Row>> List(storage::ListOfReader<Row, Query> list,
                                                        const Query& query) {
    return (sources_.reader.*list)(query);
  }
  /// The same of quarantine, messages of no robot included. What was dropped is shown of a robot
  /// that has one of `fleets` now.
  [[nodiscard]] absl::StatusOr<QuarantineView> Quarantine(const storage::QuarantineQuery& query,
                                                          const std::vector<std::string>& fleets);
  /// A page of the robot's story (StoryOf), which is empty if the robot has none of the query's
  /// fleets now. kNotFound instead if the robot is not in memory, or has none of them, and the
  /// first page tells nothing of it.
  [[nodiscard]] absl::StatusOr<StoryPage> Story(StoryQuery query);
  // What is present now, by our clock; query.now is ignored.
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ShapeRow>> Shapes(
      storage::PresentQuery query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ObjectRow>> Objects(
      storage::PresentQuery query);
  /// Never waits.
  [[nodiscard]] StatusView Status() const;

 private:
  struct Lookup;
  /// What a list looks at: it stays while the list is made.
  struct Seen {
    std::shared_ptr<const GlanceMap> foreign;
    std::shared_ptr<const FaultCounts::Map> faults;
  };

  /// Whether the robot has one of these fleets now; nothing: it is not in memory. What is no robot
  /// has none.
  [[nodiscard]] std::optional<bool> IsOf(const std::string& ruri,
                                         const std::vector<std::string>& fleets) const;
  [[nodiscard]] bool RobotsAreUnread() const;
  /// The error for a robot that is not in memory.
  [[nodiscard]] absl::Status Unknown(const std::string& ruri) const;
  /// Asks the store what is not in memory, if it answers soon; else as it was last read.
  [[nodiscard]] Seen See(bool with_faults);
  [[nodiscard]] FilterSources FilterSourcesOf(const Seen& seen) const;
  /// One robot, with the parts that are in memory.
  [[nodiscard]] RobotView Look(const robot::Robot& robot, const PartSet& parts) const;
  /// Copies what twins and drones report. Returns about how many bytes the large parts take.
  std::size_t CopyLarge(RobotView& view, const PartSet& parts) const;
  /// Adds what the store has. Errors: of the reader, only if stored parts are wanted.
  [[nodiscard]] absl::Status FillPage(RobotsPage& page, const PartSet& parts);
  void FillRobot(std::vector<RobotView>& one);
  /// Adds the store's part to a list without stored parts, if the store answers soon.
  void FillBriefly(RobotsPage& page);
  /// Reads what the store has of robots that other processes hold. Returns how many of `robots`,
  /// from the first, are complete.
  [[nodiscard]] absl::StatusOr<std::size_t> FillForeign(std::vector<RobotView>& robots) const;
  /// False if the store did not answer; the numbers are then the last that were read.
  bool FillCounts(std::vector<RobotView>& robots);
  /// Fills the stored parts in `parts`. Returns how many of `robots`, from the first, are complete.
  [[nodiscard]] absl::StatusOr<std::size_t> FillStored(std::vector<RobotView>& robots,
                                                       const PartSet& parts);

  Sources sources_;
  const SystemTime started_at_;
  StoredCounts counts_;
  ForeignGlances foreign_;
  SortedRobots sorted_;
  BriefLook brief_look_;
};

}  // namespace uplink::view
