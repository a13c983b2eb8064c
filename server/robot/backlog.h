#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "server/robot/batch_head.h"

namespace uplink::robot {

/// A larger backlog is a mistake, such as a count that fell below zero: numbers of a session do not
/// jump further either (session::kSeqJumpMax).
inline constexpr std::uint64_t kBacklogUplinksMax = std::uint64_t{1} << 32U;
/// A message that waits for longer was kept before the agent's clock was set.
inline constexpr milliseconds kBacklogAgeMax = std::chrono::hours(24 * 3653);

/// How far behind an agent is, as it said with its last batch. A value.
struct Backlog {
  std::uint64_t uplinks = 0;
  /// Since when the oldest of them waits, by our clock; empty: none waits, or it is not known.
  std::optional<SystemTime> oldest_unsent{};
  SystemTime said_at;

  friend bool operator==(const Backlog&, const Backlog&) = default;
};

/// What a batch that arrived at `now` says about its agent's backlog; empty if that is nothing, or
/// more than kBacklogUplinksMax messages.
///
/// How long the oldest waits is the difference of two times of the agent's clock, so it is right
/// whatever that clock says. It is not known if one of them is missing, or the difference is
/// negative or over kBacklogAgeMax.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<Backlog> BacklogOf(const BatchHead& head, SystemTime now);

}  // namespace uplink::robot
