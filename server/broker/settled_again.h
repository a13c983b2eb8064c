#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "server/journal/journal.h"
#include "server/mqtt/unacked.h"
#include "server/robot/wake.h"

namespace uplink::broker {

/// Acks for messages that came again after they were settled. What this process remembers of them
/// is no proof: the store may have been replaced by an older copy since, and this process has not
/// noticed yet. So each ack waits for a commit that began after the message came. That commit
/// fails while the store is away or replaced; and if the store was connected to anew, the journal
/// tells of that first, and Clear comes before Answered.
///
/// Limits:  an ack per packet id of one connection to the broker (Clear); one request to the
///          journal at a time, which covers all that came before it.
/// Thread:  confined to its owner's.
class SettledAgain final {
 public:
  /// `answered` runs on the thread of the journal's writer, and must call Answered on the owner's
  /// thread, after everything that the journal told before. The journal and all threads that use it
  /// end before this.
  SettledAgain(journal::Journal& journal, std::function<void()> answered)
      : journal_(journal), inbox_(std::move(answered)) {}

  void Add(const mqtt::AckHandle& ack);
  /// The journal answered. Returns the acks that may go out.
  [[nodiscard]] std::vector<mqtt::AckHandle> Answered();
  /// None of them may go out: their connection is gone, or the store may have gone back.
  void Clear();

 private:
  class Inbox final : public robot::WakeInbox {
   public:
    explicit Inbox(std::function<void()> answered) : answered_(std::move(answered)) {}
    /// Posts a job of its own: one that is posted already could run before the journal's news.
    void Wake(std::uint64_t /*stream*/) override { answered_(); }

   private:
    const std::function<void()> answered_;
  };

  void Ask();

  journal::Journal& journal_;
  Inbox inbox_;
  /// The journal was asked, and has not answered.
  bool asked_ = false;
  /// Those that its answer covers; those that came later.
  std::vector<mqtt::AckHandle> covered_;
  std::vector<mqtt::AckHandle> next_;
};

}  // namespace uplink::broker
