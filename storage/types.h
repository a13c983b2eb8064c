#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/presence.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"
#include "storage/clock_trust.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/latest_kind.h"
#include "storage/origin.h"

namespace uplink::storage {

/// Sessions of one robot that the store keeps (protocol: Numbers).
inline constexpr std::size_t kSessionsPerRobotMax = 8;
/// Active faults of one robot that the store takes (validation rules: what is kept per robot).
inline constexpr std::size_t kActiveFaultsPerRobotMax = 10'000;
/// Shapes, and objects, of one robot that the store keeps (validation rules). Expired ones count
/// only until something needs their place.
inline constexpr std::size_t kShapesPerRobotMax = 10'000;
inline constexpr std::size_t kObjectsPerRobotMax = 10'000;
/// How long an expired shape or object can still be asked for before the sweep deletes it.
inline constexpr std::chrono::hours kExpiredKept{1};
/// Rows that one call of Store::Sweep deletes of each kind: it must not hold up a commit.
inline constexpr std::size_t kSweepRowsMax = 1'000;
/// Rows that one call of Store::Retain deletes of each kind.
inline constexpr std::size_t kRetainRowsMax = 1'000;
/// Payloads that one robot's quarantine keeps; older rows lose theirs.
inline constexpr std::size_t kQuarantinePayloadsPerRobotMax = 1'000;
/// Quarantined numbers that one OpenStream returns, the lowest; further ones are read by pages
/// (Reader::Rejects), which holds up no commit.
inline constexpr std::size_t kOpenRejectsMax = 256;
/// Quarantined numbers of such a page.
inline constexpr std::size_t kRejectPageMax = 512;
/// Rows of one robot's quarantine that the store keeps, but for those that a Hello may still ask
/// for. At as many above Hello.settled_seq a stream ends: more would be read for each Welcome.
inline constexpr std::size_t kQuarantineRowsPerRobotMax = 10'000;
/// Rows that one call of Store::TrimQuarantine deletes of one robot.
inline constexpr std::size_t kTrimRowsMax = 1'000;
/// Open mission runs of one robot; one more closes the one that was reported least recently.
inline constexpr std::size_t kOpenRunsPerRobotMax = 1'000;
/// An open mission run that was not reported for so long is closed: as long as a robot may be
/// silent before it is forgotten (fleet.forget_after).
inline constexpr std::chrono::days kOpenRunAgeMax{30};
/// Ranges of skipped numbers that the store lists for one robot; the oldest go.
inline constexpr std::size_t kGapsPerRobotMax = 10'000;

/// Stands for the server itself where a session needs a robot: no certificate can name it, since a
/// RURI begins with `rcan://`. Its sessions are outside kSessionsPerRobotMax and in no reading of
/// robots.
inline constexpr std::string_view kServerRuri = "server";
/// Sessions of processes that are kept; the least recently used go.
inline constexpr std::size_t kServerSessionsMax = 256;

/// One life of one server process: 16 random bytes drawn at its start.
using ProcessId = std::array<std::uint8_t, 16>;

/// A robot's identity, shared by all records of the robot. Immutable.
using RobotRef = std::shared_ptr<const model::RobotId>;

/// Whether the stream that asked for an OpenStream is still there.
enum class StreamState : std::uint8_t { kOpen, kEnded };

/// What a stream's word for the fleet of its robot is worth.
enum class FleetWord : std::uint8_t {
  /// A certificate that names the robot gave it: a robot of another fleet moves.
  kMoves,
  /// A gateway gave it for its whole fleet: it stands for no robot of another fleet.
  kMatches,
};

/// A stream begins: draw the robot's next epoch, read the session's cursor.
struct OpenRequest {
  RobotRef robot;
  model::SessionId session;
  /// Hello.settled_seq: rejected numbers above it are returned.
  model::Seq settled_seq = 0;
  SystemTime at;
  /// Sessions that this process holds in memory; they are not evicted.
  std::vector<model::SessionId> sessions_held;
  /// One that has ended takes its robot from no process that has a lease and did not release it.
  StreamState stream = StreamState::kOpen;
  /// How many rejected numbers are returned at most: 1 or more.
  std::size_t rejects_max = kOpenRejectsMax;
  /// What `robot->fleet` does to a robot that the store has in another fleet.
  FleetWord fleet_word = FleetWord::kMoves;
};

/// The last change of a robot's presence that the store has.
struct StoredPresence {
  model::Presence presence = model::Presence::kUnknown;
  SystemTime since;

  friend bool operator==(const StoredPresence&, const StoredPresence&) = default;
};

/// A number that lies in quarantine, or is kept for its robot alone, and why.
struct StoredReject {
  model::Seq seq = 0;
  model::Rejection rejection;
};

struct OpenResult {
  /// False: the stream had ended, and a process that did not release its lease holds the robot; or
  /// the robot is of another fleet (`other_fleet`). Nothing was written, and nothing else is set.
  bool taken = true;
  /// In which fleet the store has the robot, where that is another one and the request's word moves
  /// nothing.
  std::optional<std::string> other_fleet;
  /// In which fleet the store had the robot, where this moved it to another.
  std::optional<std::string> moved_from;
  /// The store had a row of the robot before.
  bool was_known = false;
  /// The epoch of this stream.
  Epoch epoch = 0;
  /// The epoch since which this process holds the robot without interruption. If it differs from
  /// the one of this process's last OpenStream of the robot, another process had it in between.
  Epoch held_since = 0;
  /// Highest committed durable number of the session; 0 if the store does not know the session.
  model::Seq cursor = 0;
  /// Quarantined numbers in (settled_seq, cursor], ascending: the first rejects_max.
  std::vector<StoredReject> rejects;
  /// How many there are, counted up to kQuarantineRowsPerRobotMax.
  std::size_t rejects_total = 0;
  /// Nothing if the store has no change of the robot's presence.
  std::optional<StoredPresence> presence;
  /// Of which kinds the store has a latest message of the robot, whoever committed it.
  LatestKindSet latest_kinds = 0;
};

/// What is known of a holder that is over.
enum class HolderEnd : std::uint8_t {
  /// It gave its robots up, or is not there any more: no robot streams to it.
  kEnded,
  /// It was not heard of. It may live with its robots' streams, cut off from the store alone.
  kSilent,
};

/// A robot whose holder is over: to be held by this process from now on.
struct AdoptRequest {
  RobotRef robot;
  /// Who held it when that was read.
  ProcessId holder{};
  /// The counter of the holder's lease then; 0 if it had none.
  std::uint64_t lease_counter = 0;
  HolderEnd end = HolderEnd::kEnded;
};

struct AdoptResult {
  /// The epoch since which this process holds the robot. Nothing if it does not: another opened a
  /// stream of it or adopted it sooner, its holder renewed its lease, or the store lost it.
  std::optional<Epoch> held_since;
  /// As OpenResult's, of a robot that was adopted.
  std::optional<StoredPresence> presence;
  /// kSilent if any of those who held it since its last OpenStream was: the robot may stream to
  /// that one still.
  HolderEnd end = HolderEnd::kEnded;
};

/// What Sweep deleted.
struct Swept {
  /// Shapes and objects that had expired.
  std::size_t items = 0;
  /// Changes of shared items that nobody needs any more (shared_items.h).
  std::size_t changes = 0;
};

/// What TrimQuarantine did.
struct Trimmed {
  /// Rows that went; index: RejectReason.
  std::array<std::size_t, model::kRejectReasons + 1> dropped{};
  /// Places in the request of robots of which kTrimRowsMax rows went: there may be more.
  std::vector<std::size_t> unfinished;
};

/// A rejected payload on its way to quarantine. It stands in its message's place and number.
struct QuarantineItem {
  model::Rejection rejection;
};

/// Consecutive numbers of a session whose messages were over their rates. It stands in the last of
/// them. No payload is kept: one row says of all of them what their robot is told.
struct LimitedRange {
  /// At most the number in which it stands.
  model::Seq first = 0;
  model::Rejection rejection;
};

/// What a durable message says: a validated record of a robot, the rejected payload in its place,
/// an update of what is no robot (its robot is a stand-in, origin.h), or of several messages that
/// they were limited.
using CommitContent = std::variant<model::Record, QuarantineItem, model::ScopeUpdate, LimitedRange>;

/// One durable message.
struct CommitRecord {
  RobotRef robot;
  model::SessionId session;
  model::Seq seq = 0;
  /// OpenResult.held_since of the process's hold under which the record is committed.
  Epoch held_since = 0;
  SystemTime received_at;
  CommitContent content;
  /// The serialized payload, for quarantine: of a good record too, since the store may refuse it.
  /// Cut at the size limit; empty where thinning dropped it.
  std::string payload;
  /// Size of the payload as it came.
  std::uint64_t payload_bytes = 0;
  /// Where it came from, for its row of quarantine.
  OriginRef origin{};
  /// Set on the last record of a message that a broker delivered.
  std::optional<MessageEnd> message_end{};
};

/// A range of numbers that an agent skipped. Has no number of its own; writing it twice is writing
/// it once (key: robot, session, first).
struct GapItem {
  RobotRef robot;
  model::SessionId session;
  model::Seq first = 0;
  model::Seq last = 0;
  Epoch held_since = 0;
  SystemTime seen_at;
};

/// Configured rules that every store applies. Immutable.
struct StoreRules {
  /// Life of an object that names no expiry (forward.object_ttl); zero: for ever. Counted from its
  /// arrival.
  milliseconds object_ttl{std::chrono::hours(24)};
  /// How long rows of history are kept, and closed mission runs; zero: for ever. Whole days count:
  /// what arrived on a day (UTC) goes when the day ended longer ago than this.
  milliseconds retain_history{std::chrono::days(90)};
  /// The same of quarantine, and of gaps.
  milliseconds retain_quarantine{std::chrono::days(14)};
  /// Who vouches for the civil clock; outlives the store. While nobody does, nothing is deleted for
  /// its age or its expiry, and nothing has expired for an upsert.
  const ClockTrust* clock = nullptr;
};

/// The presence of a robot changed: a record that the server makes itself.
struct PresenceItem {
  RobotRef robot;
  model::Presence presence = model::Presence::kUnknown;
  SystemTime at;
  /// From 1, in order, in the session of the process (Batch.presence_session).
  model::Seq number = 0;
  /// As CommitRecord's: only who holds the robot judges it.
  Epoch held_since = 0;
};

/// What one transaction writes. The records of a robot stand in the order of their numbers, per
/// session.
struct Batch {
  std::vector<CommitRecord> records;
  std::vector<GapItem> gaps;
  /// In number order. Those at or below the cursor of `presence_session` are left out, so that a
  /// lost answer cannot double them.
  std::vector<PresenceItem> presence;
  /// The numbering of `presence`: one session a process and shard, under kServerRuri.
  model::SessionId presence_session;
  /// What is remembered besides, under one lease each.
  std::vector<Deliveries> deliveries{};
};

enum class OutcomeKind : std::uint8_t {
  /// Written now (for a QuarantineItem: to quarantine; for a LimitedRange: to the kept Rejects).
  kStored,
  /// At or below the cursor, or a second copy within the batch, and never rejected.
  kDuplicate,
  /// Not kept, now or (for a number at or below the cursor) earlier: its row of quarantine, or of
  /// the kept Rejects, says why.
  kRefused,
  /// This process does not hold the robot since then: another one does, or its row is gone. Or it
  /// came under a lease on topics that is over. Nothing of the record was looked at.
  kFenced,
};

/// The store's answer for one record, or for one change of presence.
struct Outcome {
  OutcomeKind kind = OutcomeKind::kStored;
  /// Of kRefused alone.
  std::optional<model::Rejection> rejection;
};

}  // namespace uplink::storage
