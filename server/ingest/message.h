#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "server/ingest/room.h"
#include "storage/commit_record.h"

namespace uplink::ingest {

/// A message as it arrived. The bytes outlive the offer.
struct Arrival {
  SteadyTime steady;
  SystemTime system;
  std::string_view payload;
  /// The payload's size, also of one that was not kept.
  std::size_t payload_bytes = 0;
  Waits waits = Waits::kStream;
  /// It is counted as in flight already: it had to wait.
  bool is_counted = false;
};

/// What a message brings, once it is taken.
struct Brought {
  /// The records to store, in order: payload and content; the port adds robot and session, and the
  /// source the numbers.
  std::vector<storage::CommitRecord> records;
  /// What the flow counts of them; nothing: it does not count.
  std::optional<std::size_t> flow_bytes{};
  /// Of a message without records: what became of it. Nothing: its source counts it later, with
  /// others.
  std::optional<metrics::Became> became{};
};

/// How a rejected message goes to quarantine.
struct Quarantined {
  bool payload_may_be_kept = false;
  /// What the flow counts of the row; nothing: it does not count.
  std::optional<std::size_t> flow_bytes{};
};

/// How the numbers of a message's records ended up.
enum class Numbered : std::uint8_t {
  /// They wait for the commit.
  kWaiting,
  /// They are settled: nothing is stored.
  kSettled,
  /// Another process or stream has the robot by now.
  kLost,
};

/// A message that its source has judged. The port calls each of these at most once per offer. Cost
/// is always first; then it depends on what becomes of the message:
///
/// | outcome                             | calls after Cost                               |
/// | ----------------------------------- | ---------------------------------------------- |
/// | it has no room and waits            | none                                           |
/// | it has no room and cannot wait      | Settle                                         |
/// | its robot alone asks for too much   | Begin, RejectLimited                           |
/// | it is over a rate                   | Begin, TakeRate, RejectLimited                 |
/// | it is rejected by itself            | Begin, TakeRate, FindRejection, Reject, Number |
/// | it is taken with records            | Begin, TakeRate, FindRejection, Take, Number   |
/// | it is taken, Brought::became is set | Begin, TakeRate, FindRejection, Take, Settle   |
/// | it is taken without either          | Begin, TakeRate, FindRejection, Take           |
///
/// Thread: that of the port.
class Message {
 public:
  virtual ~Message() = default;

  [[nodiscard]] virtual const Arrival& arrival() const = 0;
  /// What its records cost at most; nothing if it cannot bring any, so that it needs no room.
  [[nodiscard]] virtual std::optional<RecordCost> Cost() = 0;
  /// It is processed now, with room or as one that exceeds its robot's flow. What goes before it
  /// goes now.
  virtual void Begin() = 0;
  /// Takes the tokens of its sender's rates; why it is rejected if it is over one.
  [[nodiscard]] virtual std::optional<model::Rejection> TakeRate() = 0;
  /// It is rejected for its rate, or for its robot's flow. No payload is kept, and no row of
  /// quarantine: its source does what its numbers need.
  [[nodiscard]] virtual Numbered RejectLimited(const model::Rejection& rejection) = 0;
  /// Why it is rejected by itself; null if it is good.
  [[nodiscard]] virtual const model::Rejection* FindRejection() = 0;
  /// It is rejected, and its row of quarantine comes next.
  [[nodiscard]] virtual Quarantined Reject(const model::Rejection& rejection) = 0;
  /// What is live of it is held; the rest is returned.
  [[nodiscard]] virtual Brought Take() = 0;
  /// Numbers the records, which wait from now on. `rejected` is the reason of a row of quarantine.
  [[nodiscard]] virtual Numbered Number(std::vector<storage::CommitRecord>& records,
                                        std::optional<model::RejectReason> rejected) = 0;
  /// It is settled without a record.
  virtual void Settle(metrics::Became became) = 0;

 protected:
  Message() = default;
  Message(const Message&) = default;
  Message& operator=(const Message&) = default;
};

}  // namespace uplink::ingest
