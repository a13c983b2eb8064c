#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/adopt_queue.h"
#include "server/journal/ask_queue.h"
#include "server/journal/connection_log.h"
#include "server/journal/entry.h"
#include "server/journal/entry_queue.h"
#include "server/journal/gateway_use.h"
#include "server/journal/limits.h"
#include "server/journal/presence_log.h"
#include "server/loop/wake.h"
#include "server/robot/commit_client.h"

namespace uplink::journal {

/// Whether another record may be appended.
enum class Room : std::uint8_t {
  kFree,
  /// The robot's share is full, or its gateway's. A robot with nothing waiting has room for one
  /// record of any size.
  kShareFull,
  /// The journal is full; or the gateway has kGatewaySharesMax shares, even though nothing of the
  /// robot waits.
  kFull,
};

/// Everything that waits for the writer: records and gaps in a bounded queue, streams to open,
/// drones to claim, changes of presence, connections, and a requested checkpoint. Taken work that
/// is not done still counts as waiting.
///
/// Limits: JournalLimits.records_max and bytes_max, kept by the callers that append; AskQueue's,
///         PresenceLog's and ConnectionLog's.
/// Thread: thread-safe by one mutex. WriterInbox has the writer's functions.
class Inbox final {
 public:
  Inbox(const JournalLimits& limits, const Clock& clock)
      : limits_(limits), clock_(clock), connections_(limits.connections_max) {}

  // Comments are in journal.h.

  void Open(OpenEntry entry);
  void Claim(ClaimEntry entry);
  [[nodiscard]] GatewayRef GatewayOf(const std::string& name);
  void AppendMessage(robot::CommitClient& client, const AppendedBy& by,
                     std::vector<storage::CommitRecord> records, SteadyTime arrived);
  void AppendGap(robot::CommitClient& client, const AppendedBy& by, storage::GapItem gap);
  void Remember(storage::Deliveries deliveries);
  void WhenCommitted(loop::StreamRef stream);
  void NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                    std::optional<model::ConnectionEnd> why = {},
                    std::optional<SystemTime> parked_until = {});
  /// False if too many wait.
  [[nodiscard]] bool NoteConnection(storage::ConnectionItem item);
  void Adopt(AdoptEntry entry);
  void Lose(LossEntry entry);
  void Leave(LeaveEntry entry);
  void RequestCheckpoint();

  [[nodiscard]] bool HasRoom() const {
    return bytes_.load() < limits_.bytes_max && records_.load() < limits_.records_max;
  }
  [[nodiscard]] Room RoomFor(const robot::JournalUse& robot, std::size_t bytes,
                             const GatewayUse* gateway = nullptr) const;
  void WhenRoom(loop::StreamRef stream, GatewayRef gateway = nullptr);

  [[nodiscard]] std::size_t records() const { return records_.load(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  [[nodiscard]] milliseconds oldest(SteadyTime now) const;
  [[nodiscard]] bool idle() const {
    return records_.load() == 0 && opens_.unanswered() == 0 && claims_.unanswered() == 0 &&
           presence_.uncommitted() == 0 && connections_.uncommitted() == 0 &&
           !checkpoint_open_.load();
  }

 private:
  /// Its other end.
  friend class WriterInbox;

  /// A stream that waits for room, also for its gateway.
  struct Waiter {
    loop::StreamRef stream;
    GatewayRef gateway;
  };

  void Push(std::vector<Entry> entries);
  /// Whether the gateway has less than `shares` times its share of the journal now, and at most
  /// that with `bytes` more. True for null.
  [[nodiscard]] bool IsWithin(const GatewayUse* gateway, std::size_t shares,
                              std::size_t bytes) const;
  /// Whether a robot with nothing waiting has room.
  [[nodiscard]] bool HasRoomFor(const GatewayUse* gateway) const {
    return HasRoom() && IsWithin(gateway, kGatewaySharesMax, 0);
  }
  /// Something for a batch waits. Under the lock.
  [[nodiscard]] bool HasBatch() const {
    return !queue_.empty() || !presence_.empty() || !deliveries_.empty() ||
           !waiting_for_commit_.empty() || ConnectionsMayGo();
  }
  /// A new robot has its row once its stream is opened or it is claimed: connections wait for that,
  /// unless it takes so long that they would be lost.
  [[nodiscard]] bool ConnectionsMayGo() const {
    const bool rows_are_made = opens_.empty() && !opens_taken_ && claims_.empty();
    return !connections_.empty() &&
           (rows_are_made || connections_.size() >= limits_.connections_max / 2);
  }

  const JournalLimits limits_;
  const Clock& clock_;

  mutable std::mutex mutex_;
  std::condition_variable_any work_;
  EntryQueue queue_;
  OpenQueue opens_;
  /// The writer has some that the store has not answered.
  bool opens_taken_ = false;
  ClaimQueue claims_;
  AdoptQueue adopts_;
  PresenceLog presence_;
  ConnectionLog connections_;
  /// At most one item: the last kDeliveriesWaitingMax rows of the latest lease.
  std::vector<storage::Deliveries> deliveries_;
  std::vector<Waiter> waiting_for_room_;
  /// By subject. Gateways without a stream or a waiting entry are removed at the next lookup.
  std::unordered_map<std::string, std::weak_ptr<GatewayUse>> gateways_;
  /// Each once.
  std::vector<loop::StreamRef> waiting_for_commit_;
  /// When the first record of the taken batch arrived.
  std::optional<SteadyTime> batch_oldest_;

  // Entries of the queue, and taken ones that are not done.
  std::atomic<std::size_t> records_{0};
  std::atomic<std::size_t> bytes_{0};
  /// A checkpoint was requested and has not begun; has not ended.
  std::atomic<bool> checkpoint_asked_{false};
  std::atomic<bool> checkpoint_open_{false};
};

}  // namespace uplink::journal
