#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/model/rejection.h"
#include "server/cyberwave/limits.h"
#include "server/limits/token_bucket.h"

namespace uplink::cyberwave {

/// How full the journal is, as far as rates ask.
enum class JournalFill : std::uint8_t { kUpToHalf, kOverHalf };

/// How much one twin may send, its simulated robot included: kMessagesOfTwin, and of lines of logs
/// kLogLinesOfTwin. Durable messages take no part while the journal has room: after an outage a
/// bridge rightly sends all that it kept, and its live state is not to suffer for it.
///
/// Thread:  confined to its owner.
class TwinRates final {
 public:
  /// Nothing: the message may pass, and its tokens are taken. Else why it is rejected; such a
  /// message is not kept in quarantine.
  [[nodiscard]] std::optional<model::Rejection> Limit(const Judgement& judgement, JournalFill fill,
                                                      SteadyTime now);

  /// The same of metrics that change so many faults, kRecordsOfMessageMax at most. Whatever comes
  /// later says what is active then.
  [[nodiscard]] std::optional<model::Rejection> LimitFaults(std::size_t changes, SteadyTime now);

 private:
  limits::TokenBucket messages_;
  limits::TokenBucket log_lines_;
  limits::TokenBucket fault_changes_;
};

}  // namespace uplink::cyberwave
