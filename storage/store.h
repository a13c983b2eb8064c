#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/adopt.h"
#include "storage/batch.h"
#include "storage/claim.h"
#include "storage/compare.h"
#include "storage/connection.h"
#include "storage/identity.h"
#include "storage/live_row.h"
#include "storage/open_stream.h"
#include "storage/outcome.h"
#include "storage/retention.h"

namespace uplink::storage {

/// The write side of the durable sink that decides acks. The suite in tests/contract holds the
/// contract as tests, and every implementation passes it word for word.
///
/// - A session's cursor is its last committed durable number. It alone decides what is new, and it
///   never falls. The store keeps all of a batch, or nothing of it.
/// - A number is written once in the life of its session's row. A session that comes back after its
///   eviction begins anew; its older rows of quarantine stay for people and decide nothing.
/// - OpenStreams and ClaimDrones alone make a robot's row. Its rows in `live`, `sessions` and
///   `presence_latest` may outlive it: the robot goes on with them when it comes back.
/// - A process numbers its changes of presence itself, in a session under kServerRuri. They move
///   neither the robot's `last_seen` nor its row.
/// - Order is that of commits, of presence too: neither a robot's clock nor the arrival decides.
///
/// Errors:  a status means that nothing of the call is known: it may or may not have been written.
///          Calling again with the same arguments is always right: the cursor decides.
///          kUnavailable, kAborted, kResourceExhausted, kDeadlineExceeded: worth a retry after a
///          pause. Anything else: the store is broken or misconfigured; the message names it.
/// Thread:  confined to the journal's writer.
class Store {
 public:
  virtual ~Store() = default;

  /// Opens streams, one answer per request, in one transaction: this process holds their robots
  /// from then on (but see OpenResult.taken), and they are of their requests' fleets. Creates the
  /// robots' rows; touches the sessions' rows; evicts the least recently used sessions of each
  /// robot over kSessionsPerRobotMax, the requested one included, but none in `sessions_held`.
  /// Deletes the kept Rejects that the request confirms, and those of evicted sessions.
  [[nodiscard]] virtual absl::StatusOr<std::vector<OpenResult>> OpenStreams(
      std::span<const OpenRequest> requests) = 0;

  /// Adopts robots whose holders are over, one answer per request, in one transaction. Each
  /// request names another robot. Of several processes that try, one succeeds; asked again, it gets
  /// its hold.
  [[nodiscard]] virtual absl::StatusOr<std::vector<AdoptResult>> Adopt(
      std::span<const AdoptRequest> requests) = 0;

  /// Claims drones for this process, which they call: one answer per request, at most kClaimsMax,
  /// each of another robot, in one transaction. Creates the robots' rows; touches no session. Also
  /// takes the robot itself (held_since), unless another process has it: one that has a lease and
  /// did not release it, while the robot's last presence is anything but offline, or is older than
  /// the last stream that was opened. Claims that were answered before InDoubt are void: the
  /// process claims anew.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ClaimResult>> ClaimDrones(
      std::span<const ClaimRequest> requests) = 0;

  /// Commits a batch in one transaction: one outcome per record, in order, then one per change of
  /// presence: kStored, kDuplicate or kFenced.
  ///
  /// Each record is kFenced unless this process holds its robot since exactly `held_since`; so is
  /// one whose robot has no row, since OpenStreams and ClaimDrones alone make one. Gaps of such a
  /// hold are dropped. A number at or below the session's cursor, as it then is: kRefused with the
  /// stored reason if it was rejected (it lies in quarantine, or in a range that was limited), else
  /// kDuplicate. Otherwise the record is written (or, where a bound or the database refuses it, its
  /// quarantine row), and the cursor becomes its number. Durable once this returns.
  ///
  /// A record with a SampleMark is decided by that alone, once for all records of its sample, and
  /// has no cursor: kFenced for all unless this process has the drone's claim of exactly that
  /// epoch; who holds the robot does not matter. kDuplicate for all if the sample was stored
  /// before. Otherwise each is written, or its quarantine row where a bound or the database refuses
  /// it alone, and the sample is remembered.
  ///
  /// A connection is written once by its robot and id, and again with what it has now; an end that
  /// its own process told stays (Replaces). It needs no hold: it is the past of the process that
  /// served it. Those of a robot without a row are dropped, and so are the oldest of a robot over
  /// kConnectionsPerRobotMax.
  ///
  /// A fault, an event, a message, a mission report each become a row of history. The latest report
  /// of a run (robot, mission, run), the latest UiCapabilities, CurrentSettings and AgentInfo of a
  /// robot, its active faults and its shapes and objects by id follow commit order, never a robot's
  /// clock. An upsert replaces all of its id; a delete of an unknown id, and a clear of a
  /// fault that is not active, change nothing that is present. A report without a name leaves the
  /// run's name. An upsert of a shape or object that would be one more than the bound is
  /// refused; deletes always pass. Upserts count and expire by `received_at`. A report that leaves
  /// a robot with more open runs than kOpenRunsPerRobotMax closes those that were reported least
  /// recently, in order of the commits.
  [[nodiscard]] virtual absl::StatusOr<std::vector<Outcome>> Commit(const Batch& batch) = 0;

  /// Deletes shapes and objects that expired kExpiredKept before `now` or earlier, at most
  /// kSweepRowsMax of each; none until `now` is vouched for (StoreRules.clock). Also deletes
  /// changes beyond kChangesKept of each writer, at most kChangesSweptMax, and writers after
  /// kChangeWriterKept (shared_items.h); those go by no clock of ours. More may be left when as
  /// many went as may.
  [[nodiscard]] virtual absl::StatusOr<Swept> Sweep(SystemTime now) = 0;

  /// Closes mission runs that were left open and not reported for kOpenRunAgeMax before `now`, at
  /// most kSweepRowsMax. Returns how many; more may be left when it is as many as that. None until
  /// `now` is vouched for (StoreRules.clock).
  [[nodiscard]] virtual absl::StatusOr<std::size_t> CloseRuns(SystemTime now) = 0;

  /// How many mission runs Commit closed for kOpenRunsPerRobotMax since the last call.
  [[nodiscard]] virtual std::size_t TakeRunsClosed() = 0;

  /// Other processes that have connections without an end, the first by their ids, at most
  /// kOpenProcessesMax.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ProcessId>> ProcessesWithOpenConnections() = 0;
  /// Ends the open connections of a process that is over: kServerEnded, when its lease was renewed
  /// last, or at `now` if it has no lease; never before they began. What the process still tells of
  /// them takes the place of that (Replaces). At most kSweepRowsMax; returns how many.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> EndConnections(const ProcessId& process,
                                                                   SystemTime now) = 0;

  /// Trims the quarantine of these robots to kQuarantineRowsPerRobotMax. Only these rows go: first
  /// a robot's oldest of sessions that are not kept, then its oldest at or below what the Hellos of
  /// their sessions said is settled, or that did not come by the relay. At most kTrimRowsMax of a
  /// robot per call. How many went for which reason stays (Reader::QuarantineDropped). Goes by no
  /// clock.
  [[nodiscard]] virtual absl::StatusOr<Trimmed> TrimQuarantine(
      std::span<const std::string> ruris) = 0;

  /// Keeps the histories to StoreRules: deletes what arrived before the first day to keep, at most
  /// kRetainRowsMax rows of each kind and whole days that hold nothing to keep, and makes room for
  /// the days to come. Mission runs go when they have ended, or were closed, and their last report
  /// is as old. Rejects that a Hello may still ask for are kept in the transaction that deletes
  /// their row of quarantine.
  ///
  /// Deletes nothing until `now` is vouched for (StoreRules.clock).
  [[nodiscard]] virtual absl::StatusOr<Erased> Retain(SystemTime now) = 0;

  /// Writes what changed of the live states of robots, in one transaction; `rows` name each robot
  /// once. Passes over robots that this process does not hold since LiveRow::held_since: their
  /// state is not ours to keep, or not any more. Returns the places in `rows` of those, ascending.
  [[nodiscard]] virtual absl::StatusOr<std::vector<std::size_t>> Checkpoint(
      std::span<const LiveRow> rows) = 0;

  // --- A store that may have gone back ---

  /// Whether the store lost its connection, and so may be another one from now on that lacks what
  /// it told before. Until EndDoubt, every call but Compare fails with kUnavailable, and does
  /// nothing. A store that is a file never is.
  [[nodiscard]] virtual bool InDoubt() const = 0;
  /// What the store has now of robots that it answered for before, in their order. Writes nothing.
  /// At most kComparedMax; with none it only connects. After a call that failed, robots compared
  /// before it must be compared anew.
  [[nodiscard]] virtual absl::StatusOr<std::vector<FoundRobot>> Compare(
      std::span<const ToldRobot> robots) = 0;
  /// Names the database that answered last, and its server's present run. If the name is the same
  /// after a reconnect, the store has all that it confirmed. Empty before the first connection, and
  /// for a store that cannot know.
  [[nodiscard]] virtual std::string ServerRun() const { return {}; }
  /// The caller compared all that it knows, by calls that did not fail, and voided what differed.
  virtual void EndDoubt() = 0;
};

}  // namespace uplink::storage
