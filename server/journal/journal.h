#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/journal/connection_ends.h"
#include "server/journal/duty.h"
#include "server/journal/entry.h"
#include "server/journal/events.h"
#include "server/journal/gateway_use.h"
#include "server/journal/inbox.h"
#include "server/journal/limits.h"
#include "server/journal/probe.h"
#include "server/journal/quarantine_notes.h"
#include "server/journal/store_errors.h"
#include "server/journal/went_back.h"
#include "server/journal/writer_inbox.h"
#include "server/loop/wake.h"
#include "server/robot/commit_client.h"
#include "storage/batch.h"
#include "storage/claim.h"
#include "storage/commit_record.h"
#include "storage/connection.h"
#include "storage/deliveries.h"
#include "storage/identity.h"
#include "storage/open_stream.h"

namespace uplink::fleet {
class LiveSource;
}
namespace uplink::storage {
class Store;
}

namespace uplink::journal {

class Turns;

/// The bounded queue between sessions and the store, one per shard. Order is kept per robot, and
/// entries that gathered during the last commit form the next batch (natural group commit).
///
/// Inbox holds waiting entries; Turns, the writer's side, processes them.
///
/// Thread: thread-safe; call CheckpointFrom, EndConnections and what begins with On
///         before other threads use it.
class Journal final {
 public:
  /// `process` numbers the changes of presence, and must differ in every run of the process.
  Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
          metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Queues an OpenStream, ahead of the stream's first records; it replaces a queued one of the
  /// same client. `gateway`: the subject of the stream's gateway; empty without.
  void Open(robot::CommitClient& client, std::uint64_t open_id, storage::OpenRequest request,
            std::string gateway = {});
  /// Queues the claim of a drone; it replaces a queued one of the same client. `client` is the
  /// drone's, the only one of its robot. It must be shared, or it does not learn of new connections
  /// to the store. `robot` is its robot's, and learns who holds the robot: as by an OpenStream if
  /// the claim took it. If another process has it, only a stream of a lost hold ends. Append the
  /// drone's records by AppendMessage, each with its mark; records that were judged under an
  /// earlier claim are fenced.
  void Claim(robot::CommitClient& client, robot::CommitClient& robot, storage::ClaimRequest request,
             std::string gateway = {});
  /// The counter of what waits here for all robots of the gateway with this subject: the same
  /// object for the same subject while a stream or an entry has it. Null for an empty subject.
  [[nodiscard]] GatewayRef GatewayOf(const std::string& name) { return inbox_.GatewayOf(name); }
  /// Appends all records of one durable message, in the order of the numbers, for one commit.
  /// Always takes them: callers ask RoomFor first, except for a kind of entry that each robot has
  /// at most once. `by` has the client's generation when the stream began. A record of an older
  /// generation was overtaken by a fence and is not written: the cursor would pass the numbers that
  /// the fence dropped.
  void AppendMessage(robot::CommitClient& client, const AppendedBy& by,
                     std::vector<storage::CommitRecord> records, SteadyTime arrived);
  void AppendGap(robot::CommitClient& client, const AppendedBy& by, storage::GapItem gap);
  /// Deliveries without records, which the store remembers with the next commit. They join waiting
  /// ones of the same lease, and replace those of another.
  void Remember(storage::Deliveries deliveries);
  /// Wakes the stream after the next commit that begins after this, even of an empty batch. The
  /// commit shows that the store is there and has what it confirmed: after a new connection the
  /// store was compared first, and OnReconnected called. The wake may join an earlier one
  /// (loop::WakeInbox), and so run before a job that OnReconnected posted to the same thread: a
  /// stream that acks from memory must first check whether OnReconnected was called.
  void WhenCommitted(loop::StreamRef stream) { inbox_.WhenCommitted(stream); }

  /// A robot's presence changed, or until when it is parked: a record of the server's own, dropped
  /// if this process does not hold the robot. Only idle() counts it, and it holds no stream back:
  /// at most one per robot waits. `why` and `parked_until` are storage::PresenceItem's.
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                    std::optional<model::ConnectionEnd> why = {},
                    std::optional<SystemTime> parked_until = {});
  /// A robot's connection began, goes on, or ended: all that is known of it now. Never waits, and
  /// holds no stream back: it is written with a later commit, and several notes of one connection
  /// are written as the last. Dropped (OnConnectionDropped) if connections_max others wait, and if
  /// its robot has no row by then: note the beginning after Open or Claim. Only idle() counts it.
  void NoteConnection(storage::ConnectionItem item);

  /// The robot's holder is over: adopts it, unless another process does so first.
  void Adopt(AdoptEntry entry);
  /// Another process holds the robot since an epoch: lets go of it, unless this process holds it
  /// since a later one.
  void Lose(LossEntry entry);
  /// The robot should leave memory: the journal forgets it and tells it so, unless something of it
  /// waits. Then ask again later.
  void Leave(LeaveEntry entry);

  /// Sets the live states that this journal checkpoints each `every`, in turn with other work.
  /// `live` outlives the journal.
  void CheckpointFrom(fleet::LiveSource& live, milliseconds every);
  /// Calls `told` after each commit with shapes or objects, on the writer's thread: it must be
  /// short. Call at most once, as OnReconnected.
  void OnSpatial(std::function<void()> told);
  /// Calls `told` after each new connection to the store was compared, before any further commit,
  /// on the writer's thread: it must be short. A second call aborts: Writers is the only listener
  /// (Writers::Context::store_reconnected).
  void OnReconnected(std::function<void(Reconnected)> told);
  /// Calls `told` after each commit that took kSlowCommit or longer, on the writer's thread: it
  /// must be short. Call at most once, as OnReconnected.
  void OnSlowCommit(std::function<void(const SlowCommit&)> told);
  /// Calls `told` for each robot that an OpenStream moved to another fleet, on the writer's thread:
  /// it must be short. Call at most once, as OnReconnected.
  void OnMoved(std::function<void(const Moved&)> told);
  /// Calls `told` for each connection that was dropped since too many wait, with its robot, on the
  /// thread that noted it: it must be short. Call at most once, as OnReconnected.
  void OnConnectionDropped(std::function<void(const model::RobotId&)> told);
  /// From now on ends the connections of servers that are over and left them open. Call at most
  /// once, before the writer starts.
  void EndConnections(IsOver is_over);
  /// Requests a round of checkpoints that begins after this; idle() is false until it has ended.
  /// While the store is away it is tried again.
  void RequestCheckpoint();

  /// Whether a robot may append a record of `bytes` (CostOf). `robot` is its waiting records;
  /// `gateway` is that of its stream, null without.
  [[nodiscard]] Room RoomFor(const robot::JournalUse& robot, std::size_t bytes,
                             const GatewayUse* gateway = nullptr) const {
    return inbox_.RoomFor(robot, bytes, gateway);
  }
  [[nodiscard]] bool HasRoom() const { return inbox_.HasRoom(); }
  /// Wakes the stream once when there is room again, also for the gateway.
  void WhenRoom(loop::StreamRef stream, GatewayRef gateway = nullptr) {
    inbox_.WhenRoom(stream, std::move(gateway));
  }

  [[nodiscard]] std::size_t records() const { return inbox_.records(); }
  [[nodiscard]] std::size_t bytes() const { return inbox_.bytes(); }
  /// Age of the oldest waiting record; zero if none waits.
  [[nodiscard]] milliseconds oldest(SteadyTime now) const { return inbox_.oldest(now); }
  /// No record, OpenStream, claim, change of presence or checkpoint is unfinished or unreported.
  [[nodiscard]] bool idle() const { return inbox_.idle(); }

  /// The writer's side.
  [[nodiscard]] Turns& turns() { return *turns_; }

  /// The store's last error; OK after a success.
  [[nodiscard]] absl::Status last_error() const { return errors_.last(); }
  /// Why old rows of histories could not be deleted although the store is there; OK after a
  /// success.
  [[nodiscard]] absl::Status retain_error() const { return retain_error_.last(); }
  /// The same for checkpoints.
  [[nodiscard]] absl::Status checkpoint_error() const { return checkpoint_error_.last(); }
  /// Robots for which the store was found to have gone back since the last call.
  [[nodiscard]] WentBack TakeWentBack() { return went_back_.Take(); }

 private:
  Inbox inbox_;
  JournalProbe& probe_;
  WriterInbox writer_inbox_;
  StoreErrors errors_;
  QuarantineNotes quarantine_;
  DutyError retain_error_;
  DutyError checkpoint_error_;
  WentBackNotes went_back_;
  /// CheckpointFrom gave it live states to checkpoint.
  bool checkpoints_ = false;
  /// Empty without a listener.
  std::function<void()> spatial_committed_;
  std::function<void(Reconnected)> store_reconnected_;
  std::function<void(const SlowCommit&)> slow_commit_;
  std::function<void(const Moved&)> moved_;
  std::function<void(const model::RobotId&)> connection_dropped_;
  const std::unique_ptr<Turns> turns_;
};

}  // namespace uplink::journal
