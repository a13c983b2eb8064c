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
  /// May be fewer than the page's size where large parts are wanted: a page ends with the robot
  /// whose parts bring it to storage::kPageBytesMax.
  std::vector<RobotView> robots;
  /// Empty when this page is the last.
  std::string next_token;
  /// Robots that match, on all pages.
  std::int64_t total = 0;
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
/// of no robot (storage/origin.h) are not robots and appear in no list of robots.
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
  };
  explicit Queries(Sources sources);

  [[nodiscard]] absl::StatusOr<RobotsPage> Robots(const RobotsQuery& query);
  /// With all parts.
  [[nodiscard]] absl::StatusOr<RobotView> Robot(const std::string& ruri);
  /// A list of storage::Reader, such as `&storage::Reader::Events`: of all robots or of those that
  /// match, also of ones that are not in memory.
  template <typename Row, typename Query>
  [[nodiscard]] absl::StatusOr<storage::Page<Row>> List(storage::ListOfReader<Row, Query> list,
                                                        const Query& query) {
    return (sources_.reader.*list)(query);
  }
  /// The same of quarantine, messages of no robot included.
  [[nodiscard]] absl::StatusOr<QuarantineView> Quarantine(const storage::QuarantineQuery& query);
  // What is present now, by our clock; query.now is ignored.
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ShapeRow>> Shapes(
      storage::PresentQuery query);
  [[nodiscard]] absl::StatusOr<storage::Page<storage::ObjectRow>> Objects(
      storage::PresentQuery query);
  /// Never waits.
  [[nodiscard]] StatusView Status() const;

 private:
  struct Lookup;

  /// The error for a robot that is not in memory.
  [[nodiscard]] absl::Status Unknown(const std::string& ruri) const;
  /// Adds the store's part to a list without stored parts, if the store answers soon.
  void FillBriefly(RobotsPage& page, const PartSet& parts);
  /// Reads the live parts of robots that other processes hold. Returns how many of `robots`, from
  /// the first, are complete.
  [[nodiscard]] absl::StatusOr<std::size_t> FillForeign(std::vector<RobotView>& robots);
  /// False if the store did not answer; the numbers are then the last that were read.
  bool FillCounts(std::vector<RobotView>& robots);
  /// Fills the stored parts in `parts`. Returns how many of `robots`, from the first, are complete.
  [[nodiscard]] absl::StatusOr<std::size_t> FillStored(std::vector<RobotView>& robots,
                                                       const PartSet& parts);

  Sources sources_;
  const SystemTime started_at_;
  StoredCounts counts_;
  BriefLook brief_look_;
};

}  // namespace uplink::view
