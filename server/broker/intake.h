#pragma once

#include <cstdint>
#include <functional>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/records.h"
#include "server/broker/commits.h"
#include "server/broker/held_back_message.h"
#include "server/broker/limited_log.h"
#include "server/broker/message_limits.h"
#include "server/broker/payload_judge.h"
#include "server/broker/pongs.h"
#include "server/broker/probe.h"
#include "server/broker/twin_message.h"
#include "server/broker/twin_streams.h"
#include "server/ingest/port.h"
#include "server/log/rate_limited.h"
#include "server/mqtt/listener.h"

namespace uplink::broker {

/// Takes the messages of a broker one by one: known already, answered or counted here; or judged,
/// and offered to the port.
///
/// Thread:  confined to its owner's.
class Intake final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    cyberwave::Twins& twins;
    TwinStreams& streams;
    Commits& commits;
    metrics::Ledger& ledger;
    BrokerProbe& probe;
    /// Of twins that are too many, and of those that send too much: none silences another.
    log::RateLimited& refused_log;
    LimitedLog& limited_log;
    cyberwave::JudgeTerms terms;
    /// Bytes of a rejected payload that quarantine keeps (limits.payload_bytes_max).
    std::size_t payload_bytes_max = 0;
    /// Whether the journals are more than half full.
    std::function<bool()> journal_over_half;
    Pongs::Publish publish;
    const ingest::Allowances& allowances;
  };
  explicit Intake(Context context)
      : context_(std::move(context)),
        pongs_(context_.publish, context_.probe),
        payloads_(context_.terms, context_.limited_log),
        limits_({.clock = context_.clock,
                 .log = context_.limited_log,
                 .journal_over_half = context_.journal_over_half}),
        port_({.clock = context_.clock,
               .fleet = context_.fleet,
               .ledger = context_.ledger,
               .allowances = context_.allowances,
               .payload_bytes_max = context_.payload_bytes_max,
               .journal_over_half = context_.journal_over_half}),
        sources_{.twins = context_.twins,
                 .commits = context_.commits,
                 .limits = limits_,
                 .ledger = context_.ledger,
                 .probe = context_.probe} {}

  enum class Processed : std::uint8_t {
    kDone,
    /// There is no room in the journal, and the message at QoS 1 is counted as in flight:
    /// ProcessHeldBack takes it, before any other at QoS 1, or DropHeldBack.
    kHeldBack,
  };
  /// A message arrives.
  [[nodiscard]] Processed Process(const mqtt::Message& message, const cyberwave::Arrival& arrived);
  /// The message that is held, once more. Asks little while there is no room.
  [[nodiscard]] Processed ProcessHeldBack(const HeldBackMessage& held);
  /// Whether the topic of the last message is none of ours.
  [[nodiscard]] bool was_stray() const { return was_stray_; }
  /// The message that was held does not come back to us.
  void DropHeldBack();
  /// A message arrives that is not wanted now; at QoS 1 it comes again.
  void Refuse();
  /// Wakes `stream` once the journal has room that had none for the message that is held.
  void WakeWhenRoom(loop::StreamRef stream) const;

 private:
  /// One message while it is processed.
  struct Processing;

  [[nodiscard]] Processed ProcessOne(Processing& processing);
  /// True if the message came before or is retained; it needs nothing more then.
  [[nodiscard]] bool HandleRedelivery(Processing& processing);
  [[nodiscard]] Processed Judge(Processing& processing);
  /// No stream could be opened for the twin.
  [[nodiscard]] Processed HandleUnplaced(Processing& processing, const TwinStreams::Opened& place);
  /// At QoS 1 it waits for room; at QoS 0 it is refused.
  [[nodiscard]] Processed Wait(Processing& processing);
  /// It is offered to the port.
  [[nodiscard]] Processed Offer(Processing& processing, TwinStream& stream);
  /// The log names a twin of which the port did not take a message for its own sake.
  void Tell(TwinStream& stream, const ingest::Port::Offered& offered);
  void NoteLife(const Processing& processing, TwinStream& stream);
  void AnswerPing(Processing& processing);
  /// Without a row of quarantine.
  void RejectUnkept(Processing& processing, model::RejectReason reason);
  [[nodiscard]] Processed RejectLimited(Processing& processing);
  /// It is counted, and settled now.
  void Settle(Processing& processing, metrics::Became became);
  void Count(const Processing& processing, metrics::Became became);

  const Context context_;
  Pongs pongs_;
  PayloadJudge payloads_;
  MessageLimits limits_;
  ingest::Port port_;
  const TwinSources sources_;
  bool was_stray_ = false;
  /// The journal that had no room for it.
  journal::Journal* full_ = nullptr;
};

}  // namespace uplink::broker
