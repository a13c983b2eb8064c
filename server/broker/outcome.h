#pragma once

#include <span>

#include "metrics/ledger.h"
#include "schema/cyberwave/judge.h"
#include "server/cyberwave/twin_state.h"

namespace uplink::broker {

/// What became of a message that a twin's state took so. Pure.
[[nodiscard]] metrics::Became BecameOf(cyberwave::Outcome outcome);

/// Counts what a message that was judged good went without, and what in it was absurd.
void CountOdd(const cyberwave::Judgement& judgement, metrics::Ledger& ledger);
/// Counts fields that a message went without.
void CountDropped(std::span<const model::DroppedField> dropped, metrics::Ledger& ledger);

}  // namespace uplink::broker
