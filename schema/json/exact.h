#pragma once

#include <optional>
#include <string_view>

#include <boost/json.hpp>

namespace uplink::json {

/// Reads a JSON text with every fraction as the double nearest to it; Boost's own reader (1.81) may
/// miss that by a bit. Nothing for what is no JSON text. Pure; any thread.
[[nodiscard]] std::optional<boost::json::value> ParseExact(std::string_view text);

/// The number as a double; nothing for what is no number.
[[nodiscard]] std::optional<double> NumberOf(const boost::json::value& value);

}  // namespace uplink::json
