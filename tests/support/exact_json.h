#pragma once

#include <optional>
#include <string_view>

#include <boost/json.hpp>

namespace uplink::test {

/// Reads an object with every number as the double nearest to it, which Boost's own reader (1.81)
/// may miss by a bit. Nothing for a text that is no object.
[[nodiscard]] std::optional<boost::json::object> ParseExact(std::string_view text);

}  // namespace uplink::test
