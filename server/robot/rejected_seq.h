#pragma once

#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::robot {

/// A number that was rejected, as the agent is told. A value.
struct RejectedSeq {
  model::Seq seq = 0;
  model::Rejection rejection;
};

}  // namespace uplink::robot
