#pragma once

#include <string>

#include <boost/json.hpp>

// JSON for people and programs on a terminal: in a text every character that PrintableUtf8 would
// escape is a \u escape, which a reader of JSON reads as the same character. Pure; any thread.
namespace uplink::ctl {

/// On one line.
[[nodiscard]] std::string LineJson(const boost::json::value& value);
/// A member a line, indented by two spaces. No line feed at the end.
[[nodiscard]] std::string PrettyJson(const boost::json::value& value);
/// A scalar as a cell shows it: a text without quotes, nothing for null; lists and objects as on
/// one line.
[[nodiscard]] std::string ScalarText(const boost::json::value& value);

}  // namespace uplink::ctl
