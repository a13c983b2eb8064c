#pragma once

#include <cstdint>

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

}  // namespace uplink::robot
