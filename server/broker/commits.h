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

/// Numbers the records of messages, tracks their commits, and says which messages may be acked
/// then. All records of a message go together. It also recognizes redelivered messages.
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
    /// The journals whose commits show that the store has what it confirmed, and AcksAfterCommit's
    /// `answered`: it calls for OnCommitted.
    const journal::Shards& journals;
    std::function<void(std::size_t shard)> committed;
  };
  explicit Commits(Context context)
      : context_(std::move(context)),
        redeliveries_(storage::DeliveriesKept(kRememberedWindow)),
        after_commit_(context_.journals, context_.committed) {}

  /// Messages come under this lease from now on; the store remembers these deliveries of earlier
  /// ones.
  void Begin(storage::TopicHoldRef hold, const storage::DeliveryMemory& memory);
  /// Messages come by a new connection from now on.
  void BeginConnection() { after_commit_.Clear(); }
  /// The store is about to be read: nothing is released until Reread.
  void BeginReread() {
    redeliveries_.BeginReread();
    after_commit_.Clear();
  }
  /// What the store knows now, under the same lease. Unacked messages come again by another
  /// connection.
  void Reread(const storage::DeliveryMemory& memory) {
    redeliveries_.Reread(memory);
    due_.clear();
  }
  /// The broker lost the session. Returns what the store must remember of that.
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
  /// Whether the message came before, and waits or is settled. A waiting one is acked with the
  /// first; a settled one after a commit that begins later.
  [[nodiscard]] bool AckIfKnown(const Delivered& message);
  /// Settles a message that leaves no record, whatever the store has; it may be acked. `stream` is
  /// its twin's, null if it has none.
  void SettleAtOnce(const Delivered& message, TwinStream* stream);
  /// Settles a message that leaves no record because of what this process remembers of the store.
  /// Its ack waits for a commit that begins later. After a Reread a redelivery is judged again.
  void SettleAfterCommit(const Delivered& message, TwinStream& stream);
  /// Numbers its records, which wait from now on; the caller appends them to the journal. False if
  /// another process adopted the robot since: then nothing of it may be written.
  [[nodiscard]] bool Number(TwinStream& stream, const Delivered& message,
                            std::vector<storage::CommitRecord>& records,
                            std::optional<model::RejectReason> rejected);

  /// Records of the stream were settled, or another process adopted its robot.
  void OnWake(std::uint64_t stream);
  /// The shard's journal has answered for messages that wait for a later commit.
  void OnCommitted(std::size_t shard);

  /// The acks that may go out since the last call.
  [[nodiscard]] std::vector<mqtt::AckHandle> TakeReleases() { return std::exchange(due_, {}); }
  /// Whether another process adopted a robot since the last call. Its waiting messages were not
  /// written, or were written without an answer: only the store knows. They come again only on a
  /// new connection.
  [[nodiscard]] bool TakeFenced() { return std::exchange(fenced_, false); }

 private:
  /// Deliveries for the store to remember with the message's records: earlier ones of its twin that
  /// left no record, and last, at QoS 1, the message itself.
  [[nodiscard]] std::vector<storage::Delivery> DeliveriesWith(TwinStream& stream,
                                                              const Delivered& message);
  /// The stream's next records will tell the store of this message, which was settled without one.
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
