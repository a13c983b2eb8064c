#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink::cyberwave {

/// Bytes of the longest prefix in its percent-encoded form: a RURI with it, a twin's id and
/// `twin.` is as long as a RURI may be (schema/model/ids.h).
inline constexpr std::size_t kPrefixEncodedBytesMax = 186;

/// Every byte but RFC 3986's unreserved ones as `%XX`. Pure.
[[nodiscard]] std::string PercentEncoded(std::string_view text);

/// Why a text cannot be a topic prefix, in words; empty if it can. A prefix stands directly before
/// `cyberwave/`, may hold slashes, and may be empty. Pure.
[[nodiscard]] std::string_view PrefixError(std::string_view prefix);

}  // namespace uplink::cyberwave
