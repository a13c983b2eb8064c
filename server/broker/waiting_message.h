#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "server/mqtt/unacked.h"

namespace uplink::broker {

/// A message whose records wait for their commit. A value.
struct WaitingMessage {
  /// The ack to release then; empty at QoS 0, or after the connection that delivered it ended.
  std::optional<mqtt::AckHandle> ack;
  /// 0 at QoS 0; then it has no number either.
  std::uint16_t packet_id = 0;
  std::uint64_t number = 0;
  /// The numbers of its records, in its stream's session.
  model::Seq first = 0;
  model::Seq last = 0;
  /// Earlier messages of its twin that left no record; its commit tells the store of them.
  struct Earlier {
    std::uint16_t packet_id = 0;
    std::uint64_t number = 0;
  };
  std::vector<Earlier> earlier = {};
  /// Why judgement rejected it.
  std::optional<model::RejectReason> rejected;
  SteadyTime arrived;
};

}  // namespace uplink::broker
