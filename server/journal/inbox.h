#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/entry.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/held_robots.h"
#include "server/journal/limits.h"
#include "server/journal/open_queue.h"
#include "server/journal/presence_log.h"
#include "server/robot/wake.h"

namespace uplink::journal {

/// All that waits for the writer: records and gaps in a bounded queue, streams to open, changes of
/// presence, and whether a checkpoint was asked for. What was taken and is not done yet still
/// counts as waiting.
///
/// Limits: JournalLimits.records_max and bytes_max, kept by those who append; OpenQueue's and
///         PresenceLog's.
/// Thread: thread-safe by one mutex. What the writer alone calls says so.
class Inbox final {
 public:
  Inbox(const JournalLimits& limits, const Clock& clock) : limits_(limits), clock_(clock) {}

  // --- What comes in: journal.h has the comments ---

  void Open(OpenEntry entry);
  void Append(robot::CommitClient& client, std::uint64_t generation, storage::CommitRecord record,
              SteadyTime arrived);
  void AppendGap(robot::CommitClient& client, std::uint64_t generation, storage::GapItem gap);
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at);
  void BeginPresence(const storage::RobotRef& robot, model::Presence stored, SystemTime now);
  void RequestCheckpoint();

  [[nodiscard]] bool HasRoom() const {
    return bytes_.load() < limits_.bytes_max && records_.load() < limits_.records_max;
  }
  void WhenRoom(robot::StreamRef stream);

  [[nodiscard]] std::size_t records() const { return records_.load(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  [[nodiscard]] milliseconds oldest(SteadyTime now) const;
  [[nodiscard]] bool idle() const {
    return records_.load() == 0 && opens_.unopened() == 0 && presence_.uncommitted() == 0 &&
           !checkpoint_open_.load();
  }

  // --- The writer: streams ---

  struct TakenOpens {
    std::vector<OpenEntry> opens;
    /// Records, gaps or changes of presence wait too.
    bool records_wait = false;
  };
  /// OpenQueue::MoveTo.
  [[nodiscard]] TakenOpens TakeOpens(std::vector<OpenEntry> taken, std::size_t most);
  void PutBackOpens(std::vector<OpenEntry> taken);
  void NoteOpened(std::size_t count) { opens_.NoteOpened(count); }

  // --- The writer: batches ---

  struct BatchBounds {
    std::size_t records_max = 0;
    /// A batch ends with the record that reaches this.
    std::size_t bytes_max = 0;
  };
  /// Moves what goes first into `batch`, which is empty: changes of presence, and records and gaps
  /// up to the first that may not be committed yet.
  [[nodiscard]] GatheredBatch Fill(GatheredBatch batch, const BatchBounds& bounds,
                                   const HeldRobots& held);
  /// What was taken waits again, ahead of all else.
  void PutBack(GatheredBatch::Rest rest);

  struct Done {
    std::size_t records = 0;
    std::size_t bytes = 0;
    /// Nothing is left of the batch that they were taken for.
    bool batch_ended = false;
  };
  /// Records and gaps that were taken are done; wakes those who wait for room, if there is some.
  void Release(const Done& done);
  void NotePresenceCommitted(std::size_t count) { presence_.NoteCommitted(count); }

  // --- The writer: checkpoints ---

  /// A checkpoint was asked for, and no round of it has begun.
  [[nodiscard]] bool checkpoint_asked() const { return checkpoint_asked_.load(); }
  /// A round begins. True if it answers a request.
  [[nodiscard]] bool BeginCheckpoint() { return checkpoint_asked_.exchange(false); }
  /// The round that answered a request has failed: it is to be answered again.
  void RenewCheckpoint() { checkpoint_asked_.store(true); }
  /// The round has ended.
  void EndCheckpoint();

  /// Waits until something comes in, until `due`, or until `stop`. The writer's.
  void WaitUntil(SteadyTime due, const std::stop_token& stop);

 private:
  void Push(Entry entry);

  const JournalLimits limits_;
  const Clock& clock_;

  mutable std::mutex mutex_;
  std::condition_variable_any work_;
  std::deque<Entry> queue_;
  OpenQueue opens_;
  PresenceLog presence_;
  std::vector<robot::StreamRef> waiting_for_room_;
  /// When the first record of the batch that was taken arrived.
  std::optional<SteadyTime> batch_oldest_;

  // Those of the queue, and those that were taken and are not done.
  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
  /// A checkpoint was asked for and has not begun; has not ended.
  std::atomic<bool> checkpoint_asked_{false};
  std::atomic<bool> checkpoint_open_{false};
};

}  // namespace uplink::journal
