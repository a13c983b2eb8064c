#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
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

/// The bounded queue between sessions and the store, one shard: order is kept per robot, and what
/// gathered while the last commit ran is the next batch (natural group commit).
///
/// Inbox holds what waits; Turns, the writer's side, does something with it.
///
/// Thread: thread-safe; CheckpointFrom, OnSpatial, OnReconnected, OnSlowCommit and OnMoved come
///         before the other threads.
class Journal final {
 public:
  /// `process` numbers the changes of presence: it must differ in every life of the process.
  Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
          metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Queues an OpenStream, ahead of the stream's first records; it replaces a queued one of the
  /// same client. `gateway`: the subject of the one that the stream came through; empty without.
  void Open(robot::CommitClient& client, std::uint64_t open_id, storage::OpenRequest request,
            std::string gateway = {});
  /// Queues the claim of a drone, which replaces a queued one of the same client. `client` is the
  /// drone's, the only one of its robot, and shared, or it does not learn that the store was
  /// connected to anew; `robot` is its robot's. The robot is told whose it is: as by an OpenStream
  /// where the claim took it; where another process has it, no stream ends but of a hold that was
  /// lost.
  /// AppendMessage takes the drone's records, each with its mark; those that were judged under an
  /// earlier claim are fenced.
  void Claim(robot::CommitClient& client, robot::CommitClient& robot, storage::ClaimRequest request,
             std::string gateway = {});
  /// Counts what waits here of all robots of the gateway with this subject; the same object for the
  /// same subject while a stream or an entry has it. Null for an empty subject.
  [[nodiscard]] GatewayRef GatewayOf(const std::string& name) { return inbox_.GatewayOf(name); }
  /// Appends all that one durable message is, in order of the numbers: one commit has all of it.
  /// Always takes it: callers ask RoomFor before, but for what each robot has at most one of.
  /// `by` has the client's generation as of the stream's begin. A record of an older generation is
  /// one that a fence overtook on its way here. It is not written: the cursor would pass the
  /// numbers that the fence dropped.
  void AppendMessage(robot::CommitClient& client, const AppendedBy& by,
                     std::vector<storage::CommitRecord> records, SteadyTime arrived);
  void AppendGap(robot::CommitClient& client, const AppendedBy& by, storage::GapItem gap);
  /// What the store is to remember of deliveries without records, with the next commit. What waits
  /// of the same lease comes with it.
  void Remember(storage::Deliveries deliveries);
  /// Wakes the stream after the next commit that begins after this, of an empty batch if nothing
  /// else waits. It shows that the store is there and has what it told: a store that was connected
  /// to anew was compared before, and OnReconnected told. The wake may join an earlier one
  /// (loop::WakeInbox), and so run before a job that OnReconnected posted to the same thread: a
  /// stream that acks from memory first looks whether OnReconnected told.
  void WhenCommitted(loop::StreamRef stream) { inbox_.WhenCommitted(stream); }

  /// A robot's presence changed: a record of the server's own, dropped if this process does not
  /// hold the robot. It is in no count of this class but idle(), and holds no stream back: at most
  /// one per robot waits.
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at);

  /// The robot's holder is over: it is to be adopted, if nobody else does so first.
  void Adopt(AdoptEntry entry);
  /// Another process holds the robot since an epoch: it is let go, unless this process holds it
  /// since a later one.
  void Lose(LossEntry entry);
  /// The robot is to leave memory: unless something of it waits, the journal forgets it, and tells
  /// it so. What is not done now is to be asked for again.
  void Leave(LeaveEntry entry);

  /// The live states that this journal checkpoints each `every`, alternately with what waits.
  /// `live` outlives the journal.
  void CheckpointFrom(fleet::LiveSource& live, milliseconds every);
  /// `told` is called after each commit that holds shapes or objects, on the writer's thread:
  /// short. At most once, as OnReconnected.
  void OnSpatial(std::function<void()> told);
  /// `told` is called each time that the store was connected to anew and compared, before anything
  /// more is committed, on the writer's thread: short. A second call aborts: there is one listener,
  /// and Writers is it (Writers::Context::store_reconnected).
  void OnReconnected(std::function<void(Reconnected)> told);
  /// `told` is called after each commit that took kSlowCommit or longer, on the writer's thread:
  /// short. At most once, as OnReconnected.
  void OnSlowCommit(std::function<void(const SlowCommit&)> told);
  /// `told` is called for each robot that an OpenStream moved to another fleet, on the writer's
  /// thread: short. At most once, as OnReconnected.
  void OnMoved(std::function<void(const Moved&)> told);
  /// A round of checkpoints that begins after this; until it has ended, nothing is idle(). While
  /// the store is away it is tried again.
  void RequestCheckpoint();

  /// Whether a robot may append a record that costs `bytes` (CostOf). `robot` is what already waits
  /// of it; `gateway` is that of its stream, null without.
  [[nodiscard]] Room RoomFor(const robot::JournalUse& robot, std::size_t bytes,
                             const GatewayUse* gateway = nullptr) const {
    return inbox_.RoomFor(robot, bytes, gateway);
  }
  [[nodiscard]] bool HasRoom() const { return inbox_.HasRoom(); }
  /// Wakes the stream once when there is room again, for the gateway too.
  void WhenRoom(loop::StreamRef stream, GatewayRef gateway = nullptr) {
    inbox_.WhenRoom(stream, std::move(gateway));
  }

  [[nodiscard]] std::size_t records() const { return inbox_.records(); }
  [[nodiscard]] std::size_t bytes() const { return inbox_.bytes(); }
  /// Age of the oldest record that waits; zero if none does.
  [[nodiscard]] milliseconds oldest(SteadyTime now) const { return inbox_.oldest(now); }
  /// Nothing waits, not even the telling of an outcome.
  [[nodiscard]] bool idle() const { return inbox_.idle(); }

  /// What the writer drives.
  [[nodiscard]] Turns& turns() { return *turns_; }

  /// The store's last error; OK after a success.
  [[nodiscard]] absl::Status last_error() const { return errors_.last(); }
  /// Why histories could not be kept to their age, though the store is there; OK after a success.
  [[nodiscard]] absl::Status retain_error() const { return retain_error_.last(); }
  /// The same of checkpoints.
  [[nodiscard]] absl::Status checkpoint_error() const { return checkpoint_error_.last(); }
  /// Robots of which the store was found to have gone back since the last call.
  [[nodiscard]] WentBack TakeWentBack() { return went_back_.Take(); }

 private:
  Inbox inbox_;
  WriterInbox writer_inbox_;
  StoreErrors errors_;
  QuarantineNotes quarantine_;
  DutyError retain_error_;
  DutyError checkpoint_error_;
  WentBackNotes went_back_;
  /// CheckpointFrom gave it live states to checkpoint.
  bool checkpoints_ = false;
  /// Empty until somebody listens.
  std::function<void()> spatial_committed_;
  std::function<void(Reconnected)> store_reconnected_;
  std::function<void(const SlowCommit&)> slow_commit_;
  std::function<void(const Moved&)> moved_;
  const std::unique_ptr<Turns> turns_;
};

}  // namespace uplink::journal
