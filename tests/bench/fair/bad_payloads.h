#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::bench {

/// The largest payload that a server takes by default (limits.payload_bytes_max).
inline constexpr std::size_t kLargeShapeBytes = std::size_t{256} * 1024;
/// The longest text of a message for people (schema/limits.h).
inline constexpr std::size_t kLongTextBytes = 8192;
/// Readings of one telemetryExtras message (limits.extras_items_max).
inline constexpr std::size_t kFaultyReadings = 256;
/// Joints of one Robot State (schema/rcan/judge.h).
inline constexpr std::size_t kRenamedJoints = 256;
/// Ways in which Malformed is no message.
inline constexpr std::size_t kWaysToBeMalformed = 4;

// Payloads that the bad robot sends; `number` varies them. All but those that say so pass
// judgement. Thread: pure; any thread.

/// An upsert of exactly kLargeShapeBytes: all the positions that a shape may have, and words behind
/// them that nothing refers to.
[[nodiscard]] std::string LargeShape(std::size_t number);
/// A message for people with a text of kLongTextBytes letters.
[[nodiscard]] std::string LongText();
/// A message for people with a text of kLongTextBytes times U+0001.
[[nodiscard]] std::string ControlText();
/// Settings whose values are U+0001, together nearly as large as a payload may be.
[[nodiscard]] std::string ControlSettings();
/// No whole Cap'n Proto message: cut, too long, of other bytes, or empty.
[[nodiscard]] std::string Malformed(std::size_t number);
/// kFaultyReadings readings that are no finite numbers, but for `good` at the end. With none
/// good the message is rejected, else applied without the others.
[[nodiscard]] std::string FaultyExtras(std::size_t good);
/// A Robot State (JSON) with kRenamedJoints joints, whose names are of this generation alone.
[[nodiscard]] std::string RenamedJoints(std::string_view ruri, std::int64_t timestamp_us,
                                        std::uint64_t generation);
/// A good transition, as the well-behaved send.
[[nodiscard]] std::string GoodEvent(std::uint64_t number);

}  // namespace uplink::bench
