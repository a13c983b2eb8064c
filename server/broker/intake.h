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

/// Processes the messages of a broker one by one. It counts duplicates and answers pings itself; it
/// judges the others and offers them to the port.
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
    /// Logs of twins over the bound, and of twins that send too much. They are apart so that
    /// neither silences the other.
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
    /// The journal has no room, and the message at QoS 1 is counted as in flight. Call
    /// ProcessHeldBack for it before any other message at QoS 1, or DropHeldBack.
    kHeldBack,
  };
  /// A message arrives.
  [[nodiscard]] Processed Process(const mqtt::Message& message, const cyberwave::Arrival& arrived);
  /// Tries the held message again. Cheap while there is no room.
  [[nodiscard]] Processed ProcessHeldBack(const HeldBackMessage& held);
  /// Whether the topic of the last message is none of ours.
  [[nodiscard]] bool was_stray() const { return was_stray_; }
  /// Forgets the held message: it will not be tried again.
  void DropHeldBack();
  /// Refuses a message that arrives at the wrong time; at QoS 1 it comes again.
  void Refuse();
  /// Wakes `stream` once there is room in the journal that had none for the held message. Does
  /// nothing if the message waits for something else.
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
  /// Offers it to the port.
  [[nodiscard]] Processed Offer(Processing& processing, TwinStream& stream);
  /// Logs a twin whose message the port blocked because the twin stores too much.
  void Tell(TwinStream& stream, const ingest::Port::Offered& offered);
  void NoteLife(const Processing& processing, TwinStream& stream);
  void NoteConnection(const Processing& processing, TwinStream& stream);
  void AnswerPing(Processing& processing);
  /// Counts a rejection without a row in quarantine.
  void RejectUnkept(Processing& processing, model::RejectReason reason);
  [[nodiscard]] Processed RejectLimited(Processing& processing);
  /// Counts it and settles it now.
  void Settle(Processing& processing, metrics::Became became);
  void Count(const Processing& processing, metrics::Became became);

  const Context context_;
  Pongs pongs_;
  PayloadJudge payloads_;
  MessageLimits limits_;
  ingest::Port port_;
  const TwinSources sources_;
  bool was_stray_ = false;
  /// The journal that had no room for the held message.
  journal::Journal* full_ = nullptr;
};

}  // namespace uplink::broker
