#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/journal/entry.h"
#include "server/journal/held_robots.h"
#include "server/loop/wake.h"
#include "storage/batch.h"
#include "storage/connection.h"
#include "storage/deliveries.h"
#include "storage/presence.h"

namespace uplink::journal {

/// A batch on its way to the store, with the origin of each of its records and gaps.
///
/// Limits: as many entries as the journal's CallSize of a batch allows.
/// Thread: confined to the writer.
class GatheredBatch final {
 public:
  /// `presence_session` numbers the changes of presence.
  explicit GatheredBatch(const model::SessionId& presence_session) {
    batch_.presence_session = presence_session;
  }

  void Add(Entry entry);
  void SetPresence(std::vector<storage::PresenceItem> items) { batch_.presence = std::move(items); }

  void SetConnections(std::vector<storage::ConnectionItem> items) {
    batch_.connections = std::move(items);
  }

  void SetDeliveries(std::vector<storage::Deliveries> deliveries) {
    batch_.deliveries = std::move(deliveries);
  }

  /// Streams that wait for its commit, even of an empty batch (Journal::WhenCommitted).
  void SetCommitWaiters(std::vector<loop::StreamRef> streams) {
    commit_waiters_ = std::move(streams);
  }

  [[nodiscard]] bool empty() const {
    return origins_.empty() && gap_origins_.empty() && batch_.presence.empty() &&
           batch_.connections.empty() && batch_.deliveries.empty() && commit_waiters_.empty();
  }
  [[nodiscard]] const std::vector<loop::StreamRef>& commit_waiters() const {
    return commit_waiters_;
  }
  /// Records and gaps.
  [[nodiscard]] std::size_t entries() const { return origins_.size() + gap_origins_.size(); }
  /// Bytes of records and gaps.
  [[nodiscard]] std::size_t bytes() const;
  /// The number of records, of gaps, of changes of presence or of connections, whichever is most.
  [[nodiscard]] std::size_t longest() const;
  [[nodiscard]] const storage::Batch& batch() const { return batch_; }
  /// The origins of the records and of the gaps of batch(), in their order.
  [[nodiscard]] const std::vector<Origin>& origins() const { return origins_; }
  [[nodiscard]] const std::vector<Origin>& gap_origins() const { return gap_origins_; }

  struct Dropped {
    std::size_t entries = 0;
    std::size_t bytes = 0;
    /// The clients of dropped gaps, once per gap.
    std::vector<robot::ClientRef> gap_clients;
  };
  /// Drops the records and gaps that became void.
  [[nodiscard]] Dropped DropVoid();
  /// Writes into each record and gap since when its robot is held; 0 for samples, which their claim
  /// decides. No entry may be void.
  void SetHolds(const HeldRobots& held);
  /// A commit of this batch had no answer, so its records may be stored.
  void MarkTried();

  struct Rest {
    /// Records, then gaps.
    std::vector<Entry> entries;
    std::vector<storage::PresenceItem> presence;
    std::vector<storage::ConnectionItem> connections;
  };
  /// Removes what is behind the first `keep` records, gaps, changes of presence and connections,
  /// except the rest of the last message.
  [[nodiscard]] Rest TakeRest(std::size_t keep);
  void ClearPresence() { batch_.presence.clear(); }
  void ClearConnections() { batch_.connections.clear(); }
  /// Also clears deliveries and the streams that wait for the commit.
  void ClearEntries();

 private:
  storage::Batch batch_;
  std::vector<Origin> origins_;
  std::vector<Origin> gap_origins_;
  std::vector<loop::StreamRef> commit_waiters_;
};

}  // namespace uplink::journal
