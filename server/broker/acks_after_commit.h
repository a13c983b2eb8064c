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

/// Acks that rest on what this process remembers of the store: of messages that came again after
/// they were settled, and of metrics that change no fault. What it remembers is no proof: the store
/// may have been replaced by an older copy since, and this process has not noticed yet. So each ack
/// waits for a commit of a shard's journal that began after the message came. That commit fails
/// while the store is away or replaced; and if the store was connected to anew, the journal tells
/// of that first, and Clear comes before Answered.
///
/// Limits:  an ack per packet id of one connection to the broker (Clear); one request to each
///          journal at a time, which covers all that came before it.
/// Thread:  confined to its owner's.
class AcksAfterCommit final {
 public:
  /// `answered` runs on the thread of a journal's writer, and must call Answered with that shard on
  /// the owner's thread, after everything that the journal told before. The journals and all
  /// threads that use them end before this.
  AcksAfterCommit(const journal::Shards& journals, std::function<void(std::size_t shard)> answered);

  /// Which of the journals it is.
  [[nodiscard]] std::size_t ShardOf(const journal::Journal& journal) const;

  void Add(std::size_t shard, const mqtt::AckHandle& ack);
  /// The shard's journal answered. Returns the acks that may go out.
  [[nodiscard]] std::vector<mqtt::AckHandle> Answered(std::size_t shard);
  /// None of them may go out: their connection is gone, or the store may have gone back.
  void Clear();

 private:
  class Inbox final : public loop::WakeInbox {
   public:
    explicit Inbox(std::function<void(std::size_t shard)> answered)
        : answered_(std::move(answered)) {}
    /// Posts a job of its own: one that is posted already could run before the journal's news.
    void Wake(std::uint64_t shard) override { answered_(shard); }

   private:
    const std::function<void(std::size_t shard)> answered_;
  };
  struct Asked {
    /// The journal was asked, and has not answered.
    bool waits = false;
    /// Those that its answer covers; those that came later.
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
