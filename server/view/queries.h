#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "metrics/cells.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/robot_state.h"
#include "server/uncrew/drones.h"
#include "server/view/brief_look.h"
#include "server/view/broker_status.h"
#include "server/view/parts.h"
#include "server/view/stored_counts.h"
#include "storage/reader.h"

namespace uplink::view {

/// What the store has of a robot's latest, each as the JSON text of an object. A value.
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
  /// As the store last said.
  std::int64_t active_faults = 0;
  StoredParts stored;
  /// Messages over their rate since the stream began, by kind.
  std::array<std::uint64_t, metrics::kKinds> rate_limited{};
  /// What its messages at a broker said, as it stood then. Null if that is not wanted, if it is no
  /// twin that this process has heard, or if another process holds it.
  std::shared_ptr<const cyberwave::TwinParts> twin{};
  /// It speaks by calls, as a drone, or did so before.
  bool is_drone = false;
  /// What it says live is known here.
  bool calls_here = false;
  /// As its calls here last said; of a drone that does not call here, as the store last said.
  std::size_t operator_requests_open = 0;
  /// What its calls said, as it stood then. Null if that is not wanted, if it does not call this
  /// process, or if another one holds it.
  std::shared_ptr<const uncrew::LiveSamples> drone{};
};

/// Which robots, by RURI. Empty texts match everything.
struct RobotsQuery {
  std::string fleet;
  std::optional<robot::Presence> presence;
  /// 1 to storage::kPageSizeMax.
  std::uint32_t page_size = storage::kPageSizeDefault;
  std::string page_token;
  /// Live parts are copied, and the store is asked for its own, only if one of them is wanted.
  PartSet parts = PartSet::OfLists();
};

struct RobotsPage {
  /// Fewer than the page's size where large parts are wanted: a page ends with the robot whose
  /// parts pass storage::kPageBytesMax.
  std::vector<RobotView> robots;
  /// Empty when this page is the last.
  std::string next_token;
  /// Robots that match, on all pages.
  std::int64_t total = 0;
};

/// Rows of quarantine. A value.
struct QuarantineView {
  storage::Page<storage::QuarantineRow> page;
  /// Of one robot, if one was asked for: what went for its bound.
  std::vector<storage::DroppedRow> dropped;
};

/// The server in figures. A value.
struct StatusView {
  std::string version;
  SystemTime started_at;
  SystemTime now;
  fleet::PresenceCounts robots;
  std::int64_t streams = 0;
  /// By model::MessageSource. The conservation law holds on each.
  std::array<metrics::MessageCounts, model::kAllMessageSources.size()> messages{};
  std::size_t journal_records = 0;
  std::size_t journal_bytes = 0;
  milliseconds journal_oldest{0};
  /// Nothing if no broker is read.
  std::optional<BrokerStatus> broker{};
};

/// Everything that readers of the fleet ask, once, for every transport. What stands in a robot's
/// place where none has it (storage/origin.h) is no robot, and never answered.
///
/// Errors:  kInvalidArgument naming the field first (`pageToken ...`); kNotFound for a robot that
///          is not in memory, kUnavailable instead while the store's robots are not there yet;
///          what the Reader says, where rows are asked for. Robots are answered
///          while the store is away too: their active faults are then the last that were read, and
///          one robot comes without its stored parts. A list that names such a part fails; one that
///          does not waits for the store for kBriefLookWait at most, and is then as if it were
///          away.
/// Limits:  remembers one number per robot, at most for twice as many as the fleet may have.
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
    /// To the thread that may wait for the store; empty: callers wait themselves.
    BriefLook::Post to_store_thread{};
    /// True while the store's robots are not in memory yet; empty: they are.
    std::function<bool()> robots_unread{};
    /// What is heard from a broker; null: nothing is.
    const cyberwave::Twins* twins = nullptr;
    /// Waits for nothing, and may be called on any thread; empty: no broker is read.
    std::function<std::optional<BrokerStatus>()> broker{};
    /// What drones say by calls; null: none call.
    const uncrew::Drones* drones = nullptr;
  };
  explicit Queries(Sources sources);

  [[nodiscard]] absl::StatusOr<RobotsPage> Robots(const RobotsQuery& query);
  /// With all parts.
  [[nodiscard]] absl::StatusOr<RobotView> Robot(const std::string& ruri);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::FaultRow>> FaultsActive(
      const storage::HistoryQuery& query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::FaultRow>> FaultHistory(
      const storage::HistoryQuery& query);
  /// A list of storage::Reader of one robot, which query.ruri names. As Robot if the list is
  /// empty and the robot is not in memory.
  template <typename Row>
  [[nodiscard]] absl::StatusOr<storage::Page<Row>> History(storage::HistoryList<Row> list,
                                                           const storage::HistoryQuery& query) {
    return OfRobot((sources_.reader.*list)(query), query.ruri);
  }
  /// The quarantine of one robot as a history, with what is not there any more.
  [[nodiscard]] absl::StatusOr<QuarantineView> Quarantine(const storage::HistoryQuery& query);
  /// The same of all robots and of none, or of those that match: a robot that is not in memory
  /// matches too.
  [[nodiscard]] absl::StatusOr<QuarantineView> AllQuarantine(const storage::QuarantineQuery& query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ScopeUpdateRow>> ScopeUpdates(
      const storage::ScopeUpdatesQuery& query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::MissionRunRow>> MissionRuns(
      const storage::MissionsQuery& query) {
    return sources_.reader.MissionRuns(query);
  }
  [[nodiscard]] absl::StatusOr<storage::Page<storage::OperatorRequestRow>> OperatorRequests(
      const storage::OperatorRequestsQuery& query) {
    return sources_.reader.OperatorRequests(query);
  }
  // What is there now, by our clock; query.now is not looked at.
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ShapeRow>> Shapes(
      storage::PresentQuery query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ObjectRow>> Objects(
      storage::PresentQuery query);
  /// Waits for nothing.
  [[nodiscard]] StatusView Status() const;

 private:
  /// The page of a robot's rows, unless nobody knows the robot.
  template <typename Row>
  [[nodiscard]] absl::StatusOr<storage::Page<Row>> OfRobot(absl::StatusOr<storage::Page<Row>> page,
                                                           const std::string& ruri) {
    const bool empty = page.ok() && page->rows.empty();
    const bool unknown =
        storage::IsNoRobot(ruri) || (empty && sources_.fleet.Find(ruri) == nullptr);
    if (page.ok() && unknown) return Unknown(ruri);
    return page;
  }
  [[nodiscard]] absl::StatusOr<QuarantineView> WithDropped(
      storage::Page<storage::QuarantineRow> page, const std::string& ruri);
  struct Lookup;

  /// Why there is no answer on a robot that is not in memory.
  [[nodiscard]] absl::Status Unknown(const std::string& ruri) const;
  /// Fills what the store adds to a list without stored parts, as far as it answers soon.
  void FillBriefly(RobotsPage& page, const PartSet& parts);
  /// Reads the live parts of robots that other processes hold. Returns for how many of `robots`,
  /// from the first.
  [[nodiscard]] absl::StatusOr<std::size_t> FillForeign(std::vector<RobotView>& robots);
  /// False if the store could not say and the numbers are the last that were read.
  bool FillCounts(std::vector<RobotView>& robots);
  /// Fills the stored parts that `parts` wants. Returns for how many of `robots`, from the first.
  [[nodiscard]] absl::StatusOr<std::size_t> FillStored(std::vector<RobotView>& robots,
                                                       const PartSet& parts);

  Sources sources_;
  const SystemTime started_at_;
  StoredCounts counts_;
  BriefLook brief_look_;
};

}  // namespace uplink::view
