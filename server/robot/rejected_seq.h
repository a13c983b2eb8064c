#pragma once

#include <cstdint>
#include <utility>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::robot {

/// A number that was rejected, as the agent is told. A value.
struct RejectedSeq {
  model::Seq seq = 0;
  model::Rejection rejection;
  /// Of kRateLimited: after so long the content may come again, under a new number.
  std::int64_t retry_after_ms = 0;
};

/// What a Reject of kRateLimited says that comes from the store: the time that it said first is not
/// kept. A message that comes too soon after it is limited again, with a time of its own.
inline constexpr std::int64_t kStoredRetryAfterMs = 1'000;

/// A rejection as the store has it.
[[nodiscard]] inline RejectedSeq FromStore(model::Seq seq, model::Rejection rejection) {
  const bool limited = rejection.reason == model::RejectReason::kRateLimited;
  return {.seq = seq,
          .rejection = std::move(rejection),
          .retry_after_ms = limited ? kStoredRetryAfterMs : 0};
}

}  // namespace uplink::robot
