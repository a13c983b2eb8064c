#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

// Times as people write and read them. Pure; any thread.
namespace uplink::ctl {

/// `now`, `12 s`, `5 min`, `3 h 12 min`, `2 d 4 h`, `35 d`; of a time to come `in 5 min`.
[[nodiscard]] std::string AgeText(SystemTime time, SystemTime now);
/// The same of a length: `0 s` if it is under a second.
[[nodiscard]] std::string LengthText(milliseconds length);

/// How --since and its like are written, for help and errors.
inline constexpr const char* kMomentForm =
    "2h, 90s, 3d (before now), 22:00Z (the last time that it was so late), or "
    "2026-05-01T22:00:00Z";

/// The time that a text of this form names; nothing for any other text.
[[nodiscard]] std::optional<SystemTime> ParseMoment(std::string_view text, SystemTime now);

}  // namespace uplink::ctl
