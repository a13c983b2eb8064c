#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/ids.h"
#include "schema/model/mission.h"
#include "schema/model/presence.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "storage/audit.h"
#include "storage/identity.h"
#include "storage/latest_kind.h"
#include "storage/lists.h"
#include "storage/live_row.h"
#include "storage/queries.h"
#include "storage/rejects.h"
#include "storage/rows.h"

namespace uplink::storage {

/// Bytes of texts and payloads after which a page ends early, with a token: a thousand rows can be
/// as many quarter megabytes.
inline constexpr std::size_t kPageBytesMax = 16U * 1024 * 1024;

/// A row's place in its list, and where a page ended: the next one begins with the row that follows
/// it in the order of the walk. `entry` is the number that the store gave the row when it wrote it,
/// so no two rows have one position.
struct PagePosition {
  SystemTime at;
  std::uint64_t entry = 0;

  friend auto operator<=>(const PagePosition&, const PagePosition&) = default;
};

/// By arrival, newest or oldest first. A token stays valid while rows are added: a walk sees every
/// row that was there when it began exactly once.
///
/// What changes in place keeps its place: an active fault that of its raise, a run that of its
/// first report, a shape or object that of the upsert that made its id present. A row shows the
/// fleet that its robot had when it was written; an active fault, shape or object the fleet that
/// its robot has now.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  /// Of each row; EncodePageToken makes the token of what follows one.
  std::vector<PagePosition> positions;
  /// Empty when this page is the last.
  std::string next_token;
};

struct RobotRow {
  model::RobotId robot;
  SystemTime first_seen;
  /// When it was heard last: it opened a stream, was claimed, a message of it was committed, or a
  /// checkpoint names a later sign of life.
  SystemTime last_seen;
  /// The last presence change that the store has.
  std::optional<model::Presence> last_presence;
  /// When that change was; means nothing without one.
  SystemTime presence_since;
  /// As StoredPresence's.
  std::optional<SystemTime> parked_until{};
  /// The session that was used last; of several at one time, the one with the highest id. It is
  /// settled up to its last committed durable number, or up to where the last checkpoint says.
  std::optional<SettledSession> last_session;
  /// The process that opened its last stream, or adopted it.
  ProcessId holder{};
  /// It spoke by calls: it was claimed.
  bool was_claimed = false;
};

struct LatestRow {
  std::string ruri;
  LatestKind kind = LatestKind::kAgentInfo;
  /// json::Text.
  std::string body_json;
  SystemTime received_at;
};

struct ActiveFaults {
  std::string ruri;
  std::int64_t count = 0;
  /// Of the same by FaultSeverity; the last: of severities beyond those known.
  std::array<std::int64_t, model::kEnumNames<model::FaultSeverity>.size() + 1> by_severity{};

  void Add(std::int64_t severity, std::int64_t faults) {
    count += faults;
    const auto known = static_cast<std::int64_t>(by_severity.size()) - 1;
    const bool recognized = severity >= 0 && severity < known;
    by_severity[static_cast<std::size_t>(recognized ? severity : known)] += faults;
  }
};

/// Requests of a drone to its operator that are open.
struct OpenRequestCount {
  std::string ruri;
  std::int64_t count = 0;

  friend bool operator==(const OpenRequestCount&, const OpenRequestCount&) = default;
};

/// The query side of the store.
///
/// Errors:  kInvalidArgument for a page token that is none of ours (the message begins with
///          `pageToken`); kUnavailable and the like as in Store.
/// Thread:  thread-safe; a slow read never holds up a commit.
class Reader {
 public:
  virtual ~Reader() = default;

  /// Robots that have a row, since they opened a stream or were claimed; at most `robots_max`.
  /// Those heard last come first, of several at one time by RURI. Without stand-ins (origin.h).
  [[nodiscard]] virtual absl::StatusOr<std::vector<RobotRow>> Robots(std::uint32_t robots_max) = 0;
  /// How many robots have a row, without stand-ins.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> RobotCount() = 0;
  /// Their fleets whose names hold characters beyond ASCII: each once, ascending by bytes, at most
  /// `fleets_max`.
  [[nodiscard]] virtual absl::StatusOr<std::vector<std::string>> FleetsBeyondAscii(
      std::uint32_t fleets_max) = 0;

  // NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained) \
  [[nodiscard]] virtual absl::StatusOr<Page<Row>> Name(const Query& query) = 0;
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  // NOLINTEND(bugprone-macro-parentheses)
  /// What operators and servers changed, or tried to. A row whose target belongs to no fleet is
  /// found by queries of all fleets alone.
  [[nodiscard]] virtual absl::StatusOr<Page<AuditRow>> Audit(const AuditQuery& query) = 0;

  /// How many rows of a robot's quarantine went for its bound, by reason, ascending; reasons for
  /// which none did are left out.
  [[nodiscard]] virtual absl::StatusOr<std::vector<DroppedRow>> QuarantineDropped(
      const std::string& ruri) = 0;
  /// Quarantined numbers of a session, ascending; none of a session that the store does not know,
  /// nor of an earlier one that had the same id. Fewer than rows_max: there are no more.
  [[nodiscard]] virtual absl::StatusOr<std::vector<StoredReject>> Rejects(
      const RejectsQuery& query) = 0;
  /// The number of active faults of each of `ruris`; robots without any may be left out.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) = 0;
  /// The number of open requests of each of `ruris`; robots without any may be left out.
  [[nodiscard]] virtual absl::StatusOr<std::vector<OpenRequestCount>> OpenRequestCounts(
      std::span<const std::string> ruris) = 0;
  /// What the store has of each of `ruris`, of the kinds in `kinds`. Stops after the robot with
  /// which the bodies passed kPageBytesMax; `ruris` that come after it are not looked at, and
  /// `complete` robots were.
  struct LatestRows {
    std::vector<LatestRow> rows;
    /// The number of `ruris` that were looked at; at least 1 if there is any.
    std::size_t complete = 0;
  };
  [[nodiscard]] virtual absl::StatusOr<LatestRows> Latest(std::span<const std::string> ruris,
                                                          LatestKindSet kinds) = 0;
  /// The live states that were checkpointed of `ruris`, which ascend. Stops after the robot with
  /// which the bytes passed kPageBytesMax.
  struct LiveRows {
    std::vector<LiveRow> rows;
    /// The number of `ruris` that were looked at; at least 1 if there is any.
    std::size_t complete = 0;
  };
  [[nodiscard]] virtual absl::StatusOr<LiveRows> LiveOf(std::span<const std::string> ruris) = 0;
};

/// A list of Reader: `&Reader::Events`.
template <typename Row, typename Query>
using ListOfReader = absl::StatusOr<Page<Row>> (Reader::*)(const Query& query);

}  // namespace uplink::storage
