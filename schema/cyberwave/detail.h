#pragma once

#include <string>

#include <boost/json.hpp>

#include "schema/rules/violations.h"

namespace uplink::cyberwave {

/// The JSON text of an object in the sender's own form, fit to keep: texts and names without NUL
/// and with U+FFFD for control characters, numbers finite. What is not is a violation of content,
/// and null in a live message. So is, in a live message, what lies deeper than kShownDepthMax, the
/// object itself being 1 deep; a durable one has the JSON text of that in its place. It changes the
/// object.
[[nodiscard]] std::string DetailOf(boost::json::object& object, schema::Violations& violations);

/// DetailOf what stands under this name: `{}` if that is no object.
[[nodiscard]] std::string DetailIn(boost::json::object& object, std::string_view name,
                                   schema::Violations& violations);

}  // namespace uplink::cyberwave
