#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/model/rejection.h"
#include "server/broker/id_budgets.h"
#include "server/broker/limited_log.h"
#include "server/broker/limits.h"
#include "server/broker/twin_stream.h"
#include "server/mqtt/packets.h"
#include "server/robot/durable_flow.h"

namespace uplink::broker {

/// Whether a message is more than its sender may send, or may have stored. The log names who sends
/// too much.
///
/// A robot of a twin has the durable flow of any robot (limits.durable_*, and less while the
/// store's disk is nearly full). At QoS 0 it always counts. At QoS 1 our acks hold the publisher
/// back, and its backlog after an outage is honest, so there it counts only while the journal or
/// the disk is short: a message that waited instead would hold back all other twins. Environments
/// and runs have a budget each (kRecordsOfScope, kBytesOfScope), by the same rule.
///
/// Thread:  confined to the broker's.
class MessageLimits final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    LimitedLog& log;
    /// Whether the journals are more than half full.
    std::function<bool()> journal_over_half;
    /// What one robot may have stored; by default what the configuration's defaults say.
    std::function<robot::FlowLimits()> flow{};
  };
  explicit MessageLimits(Context context) : context_(std::move(context)) {}

  /// A message that was judged.
  struct Message {
    const cyberwave::Judgement& judgement;
    const mqtt::Publish& publish;
    SteadyTime arrived;
  };
  /// It is rejected and belongs to no robot, and its id has sent too many such
  /// (kRejectsOfStranger).
  [[nodiscard]] bool ExceedsUnknownSenderBudget(const Message& message, const TwinStream& stream);
  /// The message may bring records, and its robot is past its durable flow, so that it is rejected.
  /// Otherwise TakeFlow takes its tokens. To be asked before there is room: it must not wait.
  [[nodiscard]] bool IsPastFlow(const Message& message, TwinStream& stream);
  /// Why the message is rejected for the rates of its sender. Nothing: it passes, and its tokens
  /// are taken. `records` is how many it may bring (RecordsAtMost).
  [[nodiscard]] std::optional<model::RejectReason> Limit(const Message& message, TwinStream& stream,
                                                         std::size_t records);
  /// These records, of one message of the stream's robot, go to the journal.
  void TakeFlow(TwinStream& stream, std::span<const storage::CommitRecord> records,
                std::size_t payload_bytes) const;

 private:
  [[nodiscard]] bool ExceedsScopeBudget(const Message& message, bool journal_short);
  [[nodiscard]] robot::FlowLimits FlowLimitsNow() const {
    return context_.flow ? context_.flow() : robot::FlowLimits();
  }

  const Context context_;
  IdBudgets strangers_{kRejectsOfStranger};
  IdBudgets scope_records_{kRecordsOfScope};
  IdBudgets scope_bytes_{kBytesOfScope};
};

}  // namespace uplink::broker
