#pragma once

#include <cstdint>
#include <optional>

#include <google/protobuf/timestamp.pb.h>

#include "schema/base/clock.h"
#include "schema/base/rfc3339.h"

// Points in time as the fleet contract's messages have them. Pure.
namespace uplink::view {

/// A time outside the years 1 to 9999 becomes the nearest within: others have no JSON form.
[[nodiscard]] google::protobuf::Timestamp ToTimestamp(SystemTime time);
/// Its Unix milliseconds; 0 for one that is not set.
[[nodiscard]] std::int64_t UnixMs(const google::protobuf::Timestamp& time);

/// Sets a field by its `mutable_` function: `SetTime(gap, &v1::Gap::mutable_seen_at, row.seen_at)`.
/// Leaves it absent if there is no time, or the time is 0, which rows have in its place.
template <typename Message>
void SetTime(Message& message, google::protobuf::Timestamp* (Message::*field)(),
             std::optional<SystemTime> time) {
  if (time && *time != SystemTime()) *(message.*field)() = ToTimestamp(*time);
}
/// The same of Unix milliseconds.
template <typename Message>
void SetTimeMs(Message& message, google::protobuf::Timestamp* (Message::*field)(),
               std::int64_t unix_ms) {
  SetTime(message, field, FromUnixMs(unix_ms));
}

}  // namespace uplink::view
