#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "server/broker/acks_after_commit.h"
#include "server/broker/limits.h"
#include "server/broker/probe.h"
#include "server/broker/redeliveries.h"
#include "server/broker/twin_streams.h"
#include "server/journal/shards.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/unacked.h"
#include "storage/commit_record.h"
#include "storage/deliveries.h"

namespace uplink::broker {

/// What messages bring to the store, all of a message at once: numbered, and waited for. Says which
/// messages may be acked then, and knows those that come again.
///
/// Thread:  confined to its owner's.
class Commits final {
 public:
  /// The references outlive it.
  struct Context {
    TwinStreams& streams;
    metrics::Ledger& ledger;
    BrokerProbe& probe;
    const Clock& clock;
    /// Whose commits show that the store has what it told, and AcksAfterCommit's `answered`:
    /// OnCommitted is due.
    const journal::Shards& journals;
    std::function<void(std::size_t shard)> committed;
  };
  explicit Commits(Context context)
      : context_(std::move(context)),
        redeliveries_(storage::DeliveriesKept(kRememberedWindow)),
        after_commit_(context_.journals, context_.committed) {}

  /// What comes from now on comes under this lease, and this is known of what came before.
  void Begin(storage::TopicHoldRef hold, const storage::DeliveryMemory& memory);
  /// What comes from now on comes by another connection.
  void BeginConnection() { after_commit_.Clear(); }
  /// The store is to be asked what it knows: nothing is released until Reread.
  void BeginReread() {
    redeliveries_.BeginReread();
    after_commit_.Clear();
  }
  /// Under the same lease: what the store knows by now. What might have been acked comes again, by
  /// another connection.
  void Reread(const storage::DeliveryMemory& memory) {
    redeliveries_.Reread(memory);
    due_.clear();
  }
  /// The broker lost the session. Returns what is to be remembered of that.
  [[nodiscard]] storage::Deliveries EndSession();
  /// Deliveries that have expired since the last call, for the store to remember; often none.
  [[nodiscard]] storage::Deliveries TakeExpired();
  [[nodiscard]] const storage::TopicHoldRef& hold() const { return hold_; }

  /// A message as the broker delivered it. A value.
  struct Delivered {
    /// 0 at QoS 0.
    std::uint16_t packet_id = 0;
    std::optional<storage::DeliveryDigest> digest;
    std::optional<mqtt::AckHandle> ack;
    SteadyTime arrived;
  };
  /// Whether it came before, and waits or is settled. It is acked when that is; one that is settled
  /// already after a commit that begins later.
  [[nodiscard]] bool IsKnown(const Delivered& message);
  /// It is settled without a record, whatever the store has, and may be acked. `stream` is its
  /// twin's; null if it has none.
  void SettleAtOnce(const Delivered& message, TwinStream* stream);
  /// It is settled without a record because of what the store has of its twin, as this process
  /// remembers that: it is acked after a commit that begins later, and judged again if it comes
  /// again after the store was read again.
  void SettleAfterCommit(const Delivered& message, TwinStream& stream);
  /// Its records, which the caller appends to the journal, have numbers and wait from now on. False
  /// if another process adopted the robot since: nothing of it may be written.
  [[nodiscard]] bool Number(TwinStream& stream, const Delivered& message,
                            std::vector<storage::CommitRecord>& records,
                            std::optional<model::RejectReason> rejected);

  /// Something of the stream was settled, or another process adopted its robot.
  void OnWake(std::uint64_t stream);
  /// The shard's journal has answered for the messages that wait for a commit to begin later.
  void OnCommitted(std::size_t shard);

  /// Messages that may be acked since the last call.
  [[nodiscard]] std::vector<mqtt::AckHandle> TakeReleases() { return std::exchange(due_, {}); }
  /// Whether another process adopted a robot since the last call: what of it waited was not
  /// written, or was written without an answer, which the store alone knows. It comes again only by
  /// another connection.
  [[nodiscard]] bool TakeFenced() { return std::exchange(fenced_, false); }

 private:
  /// What the store is to remember with the message's records: of its twin what was settled
  /// before it without a record, and at QoS 1 itself, the last.
  [[nodiscard]] std::vector<storage::Delivery> DeliveriesWith(TwinStream& stream,
                                                              const Delivered& message);
  /// The stream's next records tell the store of the message, which was settled without one.
  void NoteSettled(TwinStream& stream, std::uint16_t packet_id);
  void AckAfterCommit(std::size_t shard, const std::optional<mqtt::AckHandle>& ack);
  void Settle(TwinStream& stream, const robot::Progress& progress);
  void Count(metrics::Became became, std::optional<model::RejectReason> reason);
  void Fence(TwinStream& stream);

  const Context context_;
  Redeliveries redeliveries_;
  AcksAfterCommit after_commit_;
  storage::TopicHoldRef hold_;
  std::vector<mqtt::AckHandle> due_;
  bool fenced_ = false;
};

}  // namespace uplink::broker
