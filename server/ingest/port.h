#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/ingest/message.h"
#include "server/ingest/room.h"

namespace uplink::ingest {

/// Every message from every source enters here; Offer decides its fate. The port decides whether
/// there is room, what a rejection writes, and how durable records reach the journal; and it
/// counts. The source numbers the message and answers its sender.
///
/// The outcome of waiting records comes back to the source by their numbers
/// (robot::RobotSessions::Take); its ledger page has the rest.
///
/// Thread: confined to its source's.
class Port final {
 public:
  /// How to treat one source's messages. The references outlive the port.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    /// The source's page.
    metrics::Ledger& ledger;
    const Allowances& allowances;
    /// Records of one robot that may wait (limits.in_flight_uplinks_max); for Waits::kStream.
    std::size_t in_flight_max = 0;
    /// Bytes of a rejected payload that quarantine keeps (limits.payload_bytes_max).
    std::size_t payload_bytes_max = 0;
    /// Whether the journals are more than half full; for Waits::kBroker.
    std::function<bool()> journal_over_half{};
    /// How to count a message whose robot another process took.
    metrics::Became lost_counts_as = metrics::Became::kRefused;
  };
  explicit Port(Context context)
      : context_(std::move(context)), allowance_(context_.allowances.Get()) {}

  enum class Answer : std::uint8_t {
    /// It is kept live, or its records wait for their commit; or its row of quarantine does, if its
    /// content was rejected.
    kTaken,
    /// Nothing was done: its source offers it again once Offered::block ends.
    kWaits,
    /// It had no room, and cannot wait.
    kRefused,
    /// It exceeded a rate or its robot's flow.
    kLimited,
  };
  struct Offered {
    Answer answer = Answer::kTaken;
    /// Why it waits or was refused, or exceeds its robot's flow.
    Block block{};
  };
  /// Decides a message's fate, by the calls in Message's table.
  [[nodiscard]] Offered Offer(const Line& line, Message& message);

  /// Notes that a message that arrived then is a sign of life of its robot.
  void NoteLife(const Line& line, SteadyTime steady, SystemTime system);
  /// What blocks records of that cost now.
  [[nodiscard]] Block FindBlock(const Line& line, Waits waits, const RecordCost& cost);
  /// Appends records whose numbers wait, all of one message.
  void Append(const Line& line, std::vector<storage::CommitRecord> records, SteadyTime arrived);
  /// Counts `bytes` of another stored record; empty: the flow does not count it.
  void TakeFlow(const Line& line, Waits waits, std::optional<std::size_t> bytes);

  /// Counts a settled message that was not offered.
  void Count(const Arrival& arrival, metrics::Became became);
  /// Counts a message that waits as in flight, until it is offered again.
  void CountHeld();
  /// Counts that the source may add to, until Publish.
  [[nodiscard]] metrics::MessageCounts& counts() { return counts_; }
  /// Tells the ledger what was counted.
  void Publish();

  /// What one robot may send, as of the last FollowReload.
  [[nodiscard]] const Allowance& allowance() const { return *allowance_; }
  /// Takes over the changes of a reload. Offer does so itself.
  void FollowReload();

 private:
  [[nodiscard]] Offered HandleNoRoom(Message& message, const Block& block);
  void RejectLimited(Message& message, const model::Rejection& rejection);
  void Reject(const Line& line, Message& message, const model::Rejection& rejection);
  void Store(const Line& line, Message& message, Brought brought,
             std::optional<model::RejectReason> rejected);
  /// Counts how old a taken message was when it arrived.
  void CountAge(const Arrival& arrival, const Brought& brought);
  /// Counts it as received, unless it was counted while it waited: then it is no longer in flight.
  void CountOnce(const Arrival& arrival);

  const Context context_;
  std::shared_ptr<const Allowance> allowance_;
  std::uint64_t allowance_version_ = 0;
  metrics::MessageCounts counts_;
  metrics::MessageAges ages_;
};

}  // namespace uplink::ingest
