#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/live_source.h"
#include "server/journal/limits.h"
#include "server/journal/presence_log.h"
#include "server/journal/probe.h"
#include "server/robot/commit_client.h"
#include "server/robot/wake.h"
#include "storage/store.h"

namespace uplink::journal {

/// The bounded queue between sessions and the store, one shard: order is kept a robot, and what
/// gathered while the last commit ran is the next batch (natural group commit).
///
/// Thread: Append, Open, HasRoom, WhenRoom and the figures: any thread. Advance: the writer alone.
class Journal final {
 public:
  /// `process` numbers the changes of presence: other than in any life before.
  Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
          metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process);

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
  /// idle(), and holds no stream back: at most one a robot waits.
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at);
  /// A robot whose last change of an earlier life of the server is `stored` is unknown from now on.
  /// A server that stopped in order has said so then; of one that was killed nobody knows when.
  void BeginPresence(const storage::RobotRef& robot, model::Presence stored, SystemTime now);

  /// Before the first Advance: the live states that this journal checkpoints each `every`, in turns
  /// with what waits. `live` outlives the journal.
  void CheckpointFrom(fleet::LiveSource& live, milliseconds every);
  /// A round of checkpoints that begins after this; until it has ended, nothing is idle(). While
  /// the store is away it is tried again.
  void RequestCheckpoint();

  [[nodiscard]] bool HasRoom() const {
    return bytes_.load() < limits_.bytes_max && records_.load() < limits_.records_max;
  }
  /// Wakes the stream once when there is room again.
  void WhenRoom(robot::StreamRef stream);

  [[nodiscard]] std::size_t records() const { return records_.load(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  /// Age of the oldest record that waits; zero if none does.
  [[nodiscard]] milliseconds oldest(SteadyTime now) const;
  /// Nothing waits, not even the telling of an outcome.
  [[nodiscard]] bool idle() const {
    return records_.load() == 0 && opens_waiting_.load() == 0 && presence_waiting_.load() == 0 &&
           !checkpoint_waiting_.load();
  }

  /// What Advance did.
  enum class Step : std::uint8_t {
    /// Nothing waits.
    kIdle,
    /// One phase of the work was done: streams opened, a batch committed, or its outcomes told.
    kWorked,
    /// The store failed; the same work is tried again by the next Advance, after a pause.
    kFailed,
  };
  /// Does the next phase. Open calls, the commit and the telling of its outcomes are phases of
  /// their own, so that a test can stop the process between any two.
  Step Advance();
  /// The store's last error; OK after a success. Any thread.
  [[nodiscard]] absl::Status last_error() const;
  /// Why histories could not be kept to their age, though the store is there; OK after a success.
  /// Any thread.
  [[nodiscard]] absl::Status retain_error() const;
  /// The same of checkpoints.
  [[nodiscard]] absl::Status checkpoint_error() const;

  /// Waits until something is queued, until the next sweep is due, or until `stop`.
  void WaitForWork(const std::stop_token& stop);

 private:
  struct Entry {
    robot::CommitClient* client = nullptr;
    std::uint64_t generation = 0;
    SteadyTime arrived;
    std::size_t bytes = 0;
    std::variant<storage::CommitRecord, storage::GapItem> item;
    bool tried = false;
  };
  struct OpenEntry {
    robot::CommitClient* client = nullptr;
    std::uint64_t open_id = 0;
    storage::OpenRequest request;
  };
  struct Owner {
    robot::CommitClient* client = nullptr;
    std::uint64_t generation = 0;
    SteadyTime arrived;
    std::size_t bytes = 0;
    /// It was part of a commit without an answer, which may have been carried out.
    bool tried = false;
  };

  void Push(Entry entry);
  bool GatherOpens();
  Step AdvanceOpens();
  void TellOpened(const OpenEntry& open, const storage::OpenResult& result);
  [[nodiscard]] bool MayCommit(const Entry& entry) const;
  bool GatherBatch();
  void TakePresence();
  void AddToBatch(Entry entry);
  void DropVoid();
  /// After a failure: leaves the later half of the call for the next ones, if it failed often. The
  /// cursor decides, so it may have been written already.
  void NoteCommitFailure();
  static storage::Outcome OutcomeOf(const Owner& owner, storage::Outcome told);
  void HalveBatch();
  void NoteOpenFailure();
  /// Counts a success of a call whose size is `now`, at most `most`.
  static void NoteSuccess(int& failures, std::size_t& now, std::size_t most);
  [[nodiscard]] bool HasBatch() const {
    return !owners_.empty() || !gap_owners_.empty() || !batch_.presence.empty();
  }
  Step AdvanceCommit();
  /// Opens streams or commits, by turns; nothing if nothing waits.
  std::optional<Step> AdvanceWork();
  /// Sweeps, or keeps histories; nothing if neither is due.
  std::optional<Step> AdvanceDuty();
  /// Nothing if no checkpoint is due.
  std::optional<Step> AdvanceCheckpoint();
  Step AdvanceSweep();
  Step AdvanceRetain();
  Step WriteCheckpoint();
  void EndCheckpoint();
  void NoteCheckpoint(const absl::Status& status);
  void CountPresence();
  void TellOutcomes();
  void Release(std::size_t records, std::size_t bytes);
  /// Of a call that robots wait for, and of a duty. That a duty works says nothing of commits that
  /// fail; a commit that works shows that the store is there.
  void NoteResult(const absl::Status& status);
  void NoteDuty(const absl::Status& status);
  void NoteErrors(absl::Status call, absl::Status duty);

  storage::Store& store_;
  const JournalLimits limits_;
  const Clock& clock_;
  metrics::Ledger& ledger_;
  JournalProbe& probe_;

  mutable std::mutex mutex_;
  std::condition_variable_any work_;
  std::deque<Entry> queue_;
  std::deque<OpenEntry> opens_;
  PresenceLog presence_;
  std::vector<robot::StreamRef> waiting_for_room_;
  /// Of the last call of the store; what is told of it, and in the probe, is counted once.
  absl::Status last_error_;
  absl::Status duty_error_;
  absl::Status retain_error_;
  absl::Status checkpoint_error_;
  std::optional<SteadyTime> batch_oldest_;

  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
  /// Changes of presence that are not committed.
  std::atomic<std::size_t> presence_waiting_{0};
  /// Streams that were asked for and not yet opened.
  std::atomic<std::size_t> opens_waiting_{0};
  /// A checkpoint was asked for and has not begun; has not ended.
  std::atomic<bool> checkpoint_asked_{false};
  std::atomic<bool> checkpoint_waiting_{false};

  // The writer's own.
  /// What the next batch, and call of OpenStreams, may hold; halved by failures.
  std::size_t batch_max_now_;
  std::size_t opens_max_now_ = kOpensPerCallMax;
  /// In a row; below zero: successes.
  int commit_failures_ = 0;
  int open_failures_ = 0;
  std::size_t checkpoint_rows_now_ = storage::kCheckpointRowsMax;
  /// Changes of presence that a halved batch left for the next, in order.
  std::vector<storage::PresenceItem> presence_left_;
  /// The last call opened streams while records waited: they are next.
  bool batch_turn_ = false;
  /// The last call swept or kept histories: what waits is next.
  bool after_duty_ = false;
  /// The last call was for what waits: a checkpoint that is due is next.
  bool after_work_ = false;
  SteadyTime sweep_due_;
  /// At once: a store may need room for today.
  SteadyTime retain_due_;
  /// Null: this journal writes no checkpoints.
  fleet::LiveSource* live_ = nullptr;
  milliseconds checkpoint_every_{0};
  SteadyTime checkpoint_began_;
  SteadyTime checkpoint_due_;
  bool checkpoint_under_way_ = false;
  /// The one that is under way was asked for.
  bool checkpoint_answers_ = false;
  std::vector<OpenEntry> opening_;
  storage::Batch batch_;
  std::vector<Owner> owners_;
  std::vector<Owner> gap_owners_;
  std::optional<std::vector<storage::Outcome>> outcomes_;
  std::unordered_map<robot::CommitClient*, storage::Epoch> held_since_;
};

}  // namespace uplink::journal
