#pragma once

#include <cstddef>

#include "metrics/ledger.h"
#include "server/robot/commit_client.h"
#include "server/robot/reject_memory.h"

namespace uplink::robot {

/// Turns the store's decision on one message, or on a range of `messages`, into a count and, if the
/// store refused a message that judgement had accepted, into a Reject for the stream. Only here
/// does a Reject come from the store. `settled` is never fenced (see CommitClient::OnFenced).
///
/// Thread: confined to the owner's lock of `rejects`.
void ApplyOutcome(const Settled& settled, std::size_t messages, RejectMemory& rejects,
                  metrics::MessageCounts& counts);

/// The counts of so many waiting messages that became void.
[[nodiscard]] metrics::MessageCounts SupersededCounts(std::size_t messages);

}  // namespace uplink::robot
