#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/model/rejection.h"
#include "server/broker/limited_log.h"
#include "server/broker/limits.h"
#include "server/broker/twin_stream.h"
#include "server/limits/keyed_buckets.h"
#include "server/mqtt/packets.h"

namespace uplink::broker {

/// Checks whether a message exceeds what its sender may send or store. The log names such senders.
///
/// Environments and runs have a budget each (PolicyId::kRecordsOfScope, kBytesOfScope), which
/// counts as a robot's flow does (ingest::Waits).
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
  };
  explicit MessageLimits(Context context) : context_(std::move(context)) {}

  /// A message that was judged.
  struct Message {
    const cyberwave::Judgement& judgement;
    const mqtt::Publish& publish;
    SteadyTime arrived;
  };
  /// The message is rejected and belongs to no robot, and its id has sent too many of those
  /// (limits::PolicyId::kRejectsOfStranger).
  [[nodiscard]] bool ExceedsUnknownSenderBudget(const Message& message, const TwinStream& stream);
  /// Why the message is rejected for the rates of its sender. If it passes, the result is empty and
  /// its tokens are taken. `records` is how many it may bring (RecordsAtMost).
  [[nodiscard]] std::optional<model::Rejection> Limit(const Message& message, TwinStream& stream,
                                                      std::size_t records);

 private:
  [[nodiscard]] bool ExceedsScopeBudget(const Message& message, bool journal_short);

  const Context context_;
  limits::KeyedBuckets strangers_{limits::PolicyOf(limits::PolicyId::kRejectsOfStranger)};
  limits::KeyedBuckets scope_records_{limits::PolicyOf(limits::PolicyId::kRecordsOfScope)};
  limits::KeyedBuckets scope_bytes_{limits::PolicyOf(limits::PolicyId::kBytesOfScope)};
};

}  // namespace uplink::broker
