#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

// Points in time as people and programs read them: `2026-05-01T12:00:00.250Z` (RFC 3339, UTC). The
// fraction has three or six digits, and is left out where it is zero, as in the proto3 JSON mapping
// of google.protobuf.Timestamp. Pure; any thread.
namespace uplink {

/// The first and the last time that RFC 3339 can write: the years 1 to 9999.
inline constexpr SystemTime kRfc3339First = FromUnixMs(-62'135'596'800'000);
inline constexpr SystemTime kRfc3339Last = FromUnixMs(253'402'300'799'999);

/// A time outside the years 1 to 9999 shows as the nearest within.
[[nodiscard]] std::string Rfc3339(SystemTime time);
/// The same of Unix microseconds.
[[nodiscard]] std::string Rfc3339OfUs(std::int64_t unix_us);

/// The time that the text names, its fraction cut to milliseconds; nothing for what is not of
/// RFC 3339. `T` and `Z` are capitals, and an offset (`+02:00`) stands in the place of `Z`.
[[nodiscard]] std::optional<SystemTime> FromRfc3339(std::string_view text);

}  // namespace uplink
