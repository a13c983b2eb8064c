#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "server/journal/shards.h"
#include "server/loop/wake.h"
#include "server/mqtt/unacked.h"

namespace uplink::broker {

/// Acks that rely on what this process remembers of the store: those of messages that came again
/// after they were settled, and of metrics that change no fault. The memory proves nothing, since
/// the store may have been replaced by an older copy without our notice. So each ack waits for a
/// commit of a shard's journal that began after the message came. That commit fails while the store
/// is away or replaced. After a new connection to the store, the journal reports that first, so
/// Clear comes before Answered.
///
/// Limits:  one ack per packet id of one connection to the broker (Clear); one request to each
///          journal at a time, which covers all acks that were added before it.
/// Thread:  confined to its owner's.
class AcksAfterCommit final {
 public:
  /// `answered` runs on the thread of a journal's writer. It must call Answered with that shard on
  /// the owner's thread, after everything that the journal reported before. The journals and all
  /// threads that use them end before this.
  AcksAfterCommit(const journal::Shards& journals, std::function<void(std::size_t shard)> answered);

  /// The number of the journal's shard.
  [[nodiscard]] std::size_t ShardOf(const journal::Journal& journal) const;

  void Add(std::size_t shard, const mqtt::AckHandle& ack);
  /// The shard's journal answered. Returns the acks that may go out.
  [[nodiscard]] std::vector<mqtt::AckHandle> Answered(std::size_t shard);
  /// Drops all acks: their connection is gone, or the store may be an older copy.
  void Clear();

 private:
  class Inbox final : public loop::WakeInbox {
   public:
    explicit Inbox(std::function<void(std::size_t shard)> answered)
        : answered_(std::move(answered)) {}
    /// Posts a new job each time: one that is posted already could run before the journal's news.
    void Wake(std::uint64_t shard) override { answered_(shard); }

   private:
    const std::function<void(std::size_t shard)> answered_;
  };
  struct Asked {
    /// The journal was asked, and has not answered.
    bool waits = false;
    /// Acks that its answer covers, and acks that were added later.
    std::vector<mqtt::AckHandle> covered;
    std::vector<mqtt::AckHandle> next;
  };

  void Ask(std::size_t shard);

  const journal::Shards& journals_;
  Inbox inbox_;
  /// Of each journal.
  std::vector<Asked> asked_;
};

}  // namespace uplink::broker
