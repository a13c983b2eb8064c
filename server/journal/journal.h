#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/journal/inbox.h"
#include "server/journal/limits.h"
#include "server/journal/probe.h"
#include "server/journal/step.h"
#include "server/journal/store_errors.h"
#include "server/robot/commit_client.h"
#include "server/robot/wake.h"
#include "storage/types.h"

namespace uplink::fleet {
class LiveSource;
}
namespace uplink::storage {
class Store;
}

namespace uplink::journal {

/// The bounded queue between sessions and the store, one shard: order is kept per robot, and what
/// gathered while the last commit ran is the next batch (natural group commit).
///
/// Decides which step of the writer's thread is next. Inbox holds what waits; Opening, Committing
/// and the duties do something with it.
///
/// Thread: CheckpointFrom: before the first Advance. Advance and WaitForWork: the writer alone. All
///         else: any thread.
class Journal final {
 public:
  using Step = journal::Step;

  /// `process` numbers the changes of presence: it must differ in every life of the process.
  Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
          metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Queues an OpenStream, ahead of the stream's first records; it replaces a queued one of the
  /// same client.
  void Open(robot::CommitClient& client, std::uint64_t open_id, storage::OpenRequest request);
  /// Appends one durable message. Always takes it: callers ask HasRoom before each message.
  /// `generation` is the client's when the record's stream began: a record that a fence overtook on
  /// its way here must not be written, since the cursor would pass those that the fence dropped.
  void Append(robot::CommitClient& client, std::uint64_t generation, storage::CommitRecord record,
              SteadyTime arrived);
  void AppendGap(robot::CommitClient& client, std::uint64_t generation, storage::GapItem gap);

  /// A robot's presence changed: a record of the server's own. It is in no count of this class but
  /// idle(), and holds no stream back: at most one per robot waits.
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at);
  /// A robot whose last change of an earlier life of the server is `stored` is unknown from now on.
  /// A server that stopped in order has said so then; of one that was killed nobody knows when.
  void BeginPresence(const storage::RobotRef& robot, model::Presence stored, SystemTime now);

  /// The live states that this journal checkpoints each `every`, alternately with what waits.
  /// `live` outlives the journal.
  void CheckpointFrom(fleet::LiveSource& live, milliseconds every);
  /// A round of checkpoints that begins after this; until it has ended, nothing is idle(). While
  /// the store is away it is tried again.
  void RequestCheckpoint();

  [[nodiscard]] bool HasRoom() const { return inbox_.HasRoom(); }
  /// Wakes the stream once when there is room again.
  void WhenRoom(robot::StreamRef stream) { inbox_.WhenRoom(stream); }

  [[nodiscard]] std::size_t records() const { return inbox_.records(); }
  [[nodiscard]] std::size_t bytes() const { return inbox_.bytes(); }
  /// Age of the oldest record that waits; zero if none does.
  [[nodiscard]] milliseconds oldest(SteadyTime now) const { return inbox_.oldest(now); }
  /// Nothing waits, not even the telling of an outcome.
  [[nodiscard]] bool idle() const { return inbox_.idle(); }

  /// Does the next step. OpenStreams, the commit and the telling of its outcomes are steps of
  /// their own, so that a test can stop the process between any two.
  Step Advance();
  /// Waits until something is queued, until the next duty is due, or until `stop`.
  void WaitForWork(const std::stop_token& stop);

  /// The store's last error; OK after a success.
  [[nodiscard]] absl::Status last_error() const { return errors_.last(); }
  /// Why histories could not be kept to their age, though the store is there; OK after a success.
  [[nodiscard]] absl::Status retain_error() const;
  /// The same of checkpoints.
  [[nodiscard]] absl::Status checkpoint_error() const;

 private:
  struct WriterState;

  /// Opens streams or commits, alternately; nothing if nothing waits.
  std::optional<Step> AdvanceWork();
  bool GatherOpens();
  /// Deletes what expired or what is too old; nothing if neither is due.
  std::optional<Step> AdvanceDuty();

  const Clock& clock_;
  Inbox inbox_;
  StoreErrors errors_;
  const std::unique_ptr<WriterState> state_;
};

}  // namespace uplink::journal
