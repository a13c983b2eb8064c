#pragma once

#include <cstdint>
#include <utility>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::robot {

/// A rejected number, as the agent is told. A value.
struct RejectedSeq {
  model::Seq seq = 0;
  model::Rejection rejection;
  /// For kRateLimited: after so long the content may come again, under a new number.
  std::int64_t retry_after_ms = 0;
};

/// The retry_after_ms of a kRateLimited Reject from the store, which does not keep the original
/// time. A message that comes too soon is limited again, with its own time.
inline constexpr std::int64_t kStoredRetryAfterMs = 1'000;

/// A rejection as the store has it.
[[nodiscard]] inline RejectedSeq FromStore(model::Seq seq, model::Rejection rejection) {
  const bool limited = rejection.reason == model::RejectReason::kRateLimited;
  return {.seq = seq,
          .rejection = std::move(rejection),
          .retry_after_ms = limited ? kStoredRetryAfterMs : 0};
}

}  // namespace uplink::robot
