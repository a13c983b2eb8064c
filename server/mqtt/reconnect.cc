#include "server/mqtt/reconnect.h"

#include <algorithm>

namespace uplink::mqtt {

Reconnect::Pause Reconnect::After(EndReason reason, std::optional<milliseconds> lived,
                                  std::uint64_t random) {
  const bool soon = lived.has_value() && *lived < limits_.soon;
  const bool wordless = reason == EndReason::kClosed || reason == EndReason::kBroken;
  if (lived.has_value() && (!soon || reason == EndReason::kBehind)) backoff_.Reset();
  soon_ends_ = soon && wordless ? soon_ends_ + 1 : 0;
  if (reason == EndReason::kIdTaken || soon_ends_ >= limits_.soon_ends_max) {
    // Until a connection lives, each further end counts as the same.
    soon_ends_ = std::min(soon_ends_, limits_.soon_ends_max - 1);
    const auto more = static_cast<std::uint64_t>(limits_.taken_pause.count() / 10) + 1;
    return {limits_.taken_pause + milliseconds(random % more), true};
  }
  return {backoff_.Next(random), false};
}

}  // namespace uplink::mqtt
