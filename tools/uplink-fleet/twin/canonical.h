#pragma once

#include <string>
#include <string_view>

#include <boost/json.hpp>

namespace uplink::synthetic {

/// The same text for values that mean the same: members in order, each number as the double that it
/// is. Pure; any thread.
[[nodiscard]] std::string CanonicalText(const boost::json::value& value);

/// As a text of JSON. Pure; any thread.
[[nodiscard]] inline boost::json::string JsonText(std::string_view text) {
  return boost::json::string(text.data(), text.size());
}

}  // namespace uplink::synthetic
