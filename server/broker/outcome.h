#pragma once

#include "schema/cyberwave/judge.h"
#include "server/broker/message_counts.h"
#include "server/broker/probe.h"
#include "server/cyberwave/twin_state.h"

namespace uplink::broker {

/// What became of a message that a twin's state took so. Pure.
[[nodiscard]] Became BecameOf(cyberwave::Outcome outcome);

/// Counts what a message that was judged good went without, and what in it was absurd.
void CountOdd(const cyberwave::Judgement& judgement, MessageCounts& counts, BrokerProbe& probe);

}  // namespace uplink::broker
