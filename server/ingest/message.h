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
  /// The payload's size, even if it was not kept.
  std::size_t payload_bytes = 0;
  Waits waits = Waits::kStream;
  /// It had to wait, and is counted as in flight already.
  bool is_counted = false;
  /// When it was sampled by its sender's clock, Unix milliseconds; 0: it does not say.
  std::int64_t sampled_unix_ms = 0;
};

/// What a taken message brings.
struct Brought {
  /// The records to store, in order, with payload and content. The port adds robot and session, the
  /// source the numbers.
  std::vector<storage::CommitRecord> records;
  /// Bytes that the flow counts of them; empty: it does not count them.
  std::optional<std::size_t> flow_bytes{};
  /// For a message without records: its result. Empty: its source counts it later, with others.
  std::optional<metrics::Became> became{};
};

/// How a rejected message goes to quarantine.
struct Quarantined {
  bool payload_may_be_kept = false;
  /// Bytes that the flow counts of the row; empty: it does not count it.
  std::optional<std::size_t> flow_bytes{};
};

/// The result of numbering a message's records.
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
  /// The highest cost of its records; empty if it cannot bring any and needs no room.
  [[nodiscard]] virtual std::optional<RecordCost> Cost() = 0;
  /// It is processed now, with room or because it exceeds its robot's flow. What comes before it is
  /// sent now.
  virtual void Begin() = 0;
  /// Takes the tokens of its sender's rates; returns the rejection if it exceeds one.
  [[nodiscard]] virtual std::optional<model::Rejection> TakeRate() = 0;
  /// It is rejected for its rate, or its robot's flow, without a payload or a row of quarantine:
  /// its source does what its numbers need.
  [[nodiscard]] virtual Numbered RejectLimited(const model::Rejection& rejection) = 0;
  /// Why its content is rejected; null if it is good.
  [[nodiscard]] virtual const model::Rejection* FindRejection() = 0;
  /// It is rejected; its row of quarantine follows.
  [[nodiscard]] virtual Quarantined Reject(const model::Rejection& rejection) = 0;
  /// Keeps its live data, and returns the rest.
  [[nodiscard]] virtual Brought Take() = 0;
  /// Numbers the records, which wait from now on. `rejected` is the reason if they are a row of
  /// quarantine.
  [[nodiscard]] virtual Numbered Number(std::vector<storage::CommitRecord>& records,
                                        std::optional<model::RejectReason> rejected) = 0;
  /// Settles it without a record.
  virtual void Settle(metrics::Became became) = 0;

 protected:
  Message() = default;
  Message(const Message&) = default;
  Message& operator=(const Message&) = default;
};

}  // namespace uplink::ingest
