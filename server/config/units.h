#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::config {

/// Reads a duration: a whole number with `ms`, `s`, `m`, `h` or `d`, or a bare `0`. Nothing if the
/// text is anything else or longer than 10,000 days.
[[nodiscard]] std::optional<std::chrono::milliseconds> ParseDuration(std::string_view text);

/// Reads a size: a whole number with `B`, `KiB`, `MiB` or `GiB`, or a bare `0`. Nothing if the text
/// is anything else or does not fit 63 bits.
[[nodiscard]] std::optional<std::uint64_t> ParseBytes(std::string_view text);

/// Reads a whole number of decimal digits that fits 63 bits.
[[nodiscard]] std::optional<std::uint64_t> ParseCount(std::string_view text);

/// The shortest text that the parsers read back to the same value: `90s`, `2m`, `64KiB`, `0`.
/// `duration` is not negative.
[[nodiscard]] std::string DurationText(std::chrono::milliseconds duration);
[[nodiscard]] std::string BytesText(std::uint64_t bytes);

}  // namespace uplink::config
