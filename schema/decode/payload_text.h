#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace uplink::schema {

/// What a payload of a robot says, for people: every member by the specification's name, without
/// judging it; so also of a payload that was rejected. Or a sentence about why it cannot be read.
/// Texts in it are printable.
///
/// Limits: bounds of reading as for Judge (schema/limits.h).
/// Thread: pure; any thread.
[[nodiscard]] std::string PayloadText(std::span<const std::byte> payload);

}  // namespace uplink::schema
