#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/ask_queue.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/held_robots.h"
#include "server/journal/inbox.h"

namespace uplink::journal {

/// The writer's end of an inbox: takes waiting work, puts back what could not be done, and reports
/// what is done.
///
/// Thread: confined to the writer, while any thread uses the inbox.
class WriterInbox final {
 public:
  /// The inbox outlives it, and has only this one.
  explicit WriterInbox(Inbox& inbox) : inbox_(inbox) {}

  // --- Streams ---

  struct TakenOpens {
    std::vector<OpenEntry> opens;
    /// Records, gaps or changes of presence wait too.
    bool records_wait = false;
  };
  /// AskQueue::MoveTo.
  [[nodiscard]] TakenOpens TakeOpens(std::vector<OpenEntry> taken, std::size_t most);
  void PutBackOpens(std::vector<OpenEntry> taken);
  void CountOpened(std::size_t count) { inbox_.opens_.CountAnswered(count); }

  // --- Drones ---

  /// AskQueue::MoveTo.
  [[nodiscard]] std::vector<ClaimEntry> TakeClaims(std::vector<ClaimEntry> taken, std::size_t most);
  void PutBackClaims(std::vector<ClaimEntry> taken);
  void CountClaimed(std::size_t count) { inbox_.claims_.CountAnswered(count); }

  // --- Robots that change hands ---

  [[nodiscard]] std::vector<AdoptEntry> TakeAdopts(std::size_t most);
  /// Puts a taken entry behind those that wait.
  void AdoptLater(AdoptEntry entry);
  [[nodiscard]] std::vector<LossEntry> TakeLosses();
  [[nodiscard]] std::vector<LeaveEntry> TakeLeaves();
  /// PresenceLog::Hold and Lose.
  void HoldPresence(const std::string& ruri, storage::Epoch since,
                    const std::optional<storage::StoredPresence>& stored);
  void LosePresence(const std::string& ruri);
  /// PresenceLog::Follow.
  bool FollowPresence(const storage::RobotRef& robot,
                      const std::optional<storage::StoredPresence>& stored, Reconnected to);
  /// PresenceLog::waits.
  [[nodiscard]] bool PresenceWaits(const std::string& ruri) const;

  // --- Batches ---

  /// Moves the next entries into the empty `batch`: changes of presence, connections, records and
  /// gaps (EntryQueue::MoveTo).
  [[nodiscard]] GatheredBatch Fill(GatheredBatch batch, const BatchBounds& bounds,
                                   const HeldRobots& held);
  /// Puts taken entries back to the front.
  void PutBack(GatheredBatch::Rest rest);

  struct Done {
    std::size_t records = 0;
    std::size_t bytes = 0;
    /// Nothing is left of their batch.
    bool batch_ended = false;
  };
  /// Taken records and gaps are done; wakes streams that wait for room, if there is some.
  void Release(const Done& done);
  void CountPresenceCommitted(std::size_t count) { inbox_.presence_.CountCommitted(count); }
  void CountConnectionsCommitted(std::size_t count) { inbox_.connections_.CountCommitted(count); }

  // --- Checkpoints ---

  /// A checkpoint was requested, and no round for it has begun.
  [[nodiscard]] bool checkpoint_asked() const { return inbox_.checkpoint_asked_.load(); }
  /// A round begins. True if it answers a request.
  [[nodiscard]] bool BeginCheckpoint() { return inbox_.checkpoint_asked_.exchange(false); }
  /// The round for a request has failed: another round must answer it.
  void RenewCheckpoint() { inbox_.checkpoint_asked_.store(true); }
  /// The round has ended.
  void EndCheckpoint();

  /// Waits until something comes in, until `due`, or until `stop`.
  void WaitUntil(SteadyTime due, const std::stop_token& stop);

 private:
  Inbox& inbox_;
};

}  // namespace uplink::journal
