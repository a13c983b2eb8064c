#include "server/mqtt/reconnect.h"

#include <algorithm>

namespace uplink::mqtt {

Reconnect::Pause Reconnect::After(EndReason reason, std::optional<milliseconds> lived,
                                  std::uint64_t random) {
  const bool early = lived.has_value() && *lived < limits_.early_within;
  const bool wordless = reason == EndReason::kClosed || reason == EndReason::kBroken;
  if (lived.has_value() && (!early || reason == EndReason::kBehind)) backoff_.Reset();
  early_ends_ = early && wordless ? early_ends_ + 1 : 0;
  if (reason == EndReason::kIdTaken || early_ends_ >= limits_.early_ends_max) {
    // Until a connection lives, each further end counts as the same.
    early_ends_ = std::min(early_ends_, limits_.early_ends_max - 1);
    const auto more = static_cast<std::uint64_t>(limits_.taken_pause.count() / 10) + 1;
    return {limits_.taken_pause + milliseconds(random % more), true};
  }
  return {backoff_.Next(random), false};
}

}  // namespace uplink::mqtt
