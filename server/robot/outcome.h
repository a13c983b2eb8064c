#pragma once

#include <cstddef>

#include "metrics/ledger.h"
#include "server/robot/commit_client.h"
#include "server/robot/reject_memory.h"

namespace uplink::robot {

/// What the store decided for one message, or for a range of so many `messages`, becomes a count
/// and, where the store refused a message that judgement had passed, a Reject that the stream is to
/// be told. The one place where a Reject comes from the store. `settled` is never fenced
/// (CommitClient::OnFenced tells of that).
///
/// Thread: confined to the owner's lock of `rejects`.
void ApplyOutcome(const Settled& settled, std::size_t messages, RejectMemory& rejects,
                  metrics::MessageCounts& counts);

/// So many messages that waited are void.
[[nodiscard]] metrics::MessageCounts SupersededCounts(std::size_t messages);

}  // namespace uplink::robot
