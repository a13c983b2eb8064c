#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <boost/json.hpp>

namespace uplink::synthetic {

/// The same text for values that mean the same: members in order, each number as the double that it
/// is. Pure; any thread.
[[nodiscard]] std::string CanonicalText(const boost::json::value& value);

/// Of such a text; for telling what was sent from what was not. Pure; any thread.
[[nodiscard]] std::uint64_t FingerprintOf(std::string_view text);

}  // namespace uplink::synthetic
