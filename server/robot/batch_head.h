#pragma once

#include <cstdint>
#include <optional>

namespace uplink::robot {

/// What an agent says with a batch beside its messages, as it came: nothing of it was checked. A
/// value.
struct BatchHead {
  /// The agent's clock when the batch was sent, Unix milliseconds; 0: it did not say.
  std::int64_t sent_unix_ms = 0;
  /// Messages that wait at the agent behind the batch; empty: it did not say.
  std::optional<std::uint64_t> backlog_uplinks{};
  /// Since when the oldest of them waits, by the agent's clock, Unix milliseconds; 0: it did not
  /// say.
  std::int64_t oldest_unsent_unix_ms = 0;
};

}  // namespace uplink::robot
