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

/// Whether the journal is so full that rates hold for durable messages too.
enum class JournalFill : std::uint8_t { kUpToHalf, kOverHalf };

/// How much one twin may send, its simulated robot included: kMessagesOfTwin, and kLogLinesOfTwin
/// for lines of logs. Durable messages do not count while the journal has room: after an outage a
/// bridge rightly sends all that it kept, and live messages must not suffer for it.
///
/// Thread:  confined to its owner.
class TwinRates final {
 public:
  /// Why the message is rejected, without a row in quarantine. Empty: it passes, and its tokens are
  /// taken.
  [[nodiscard]] std::optional<model::Rejection> Limit(const Judgement& judgement, JournalFill fill,
                                                      SteadyTime now);

  /// The same for metrics that change so many faults, at most kRecordsOfMessageMax. Later metrics
  /// say again which are active.
  [[nodiscard]] std::optional<model::Rejection> LimitFaults(std::size_t changes, SteadyTime now);

 private:
  limits::TokenBucket messages_;
  limits::TokenBucket log_lines_;
  limits::TokenBucket fault_changes_;
};

}  // namespace uplink::cyberwave
