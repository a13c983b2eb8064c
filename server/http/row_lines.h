#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::http {

/// A list as NDJSON. A value.
struct RowLines {
  /// One row a line, each with its newline.
  std::string text;
  /// As it stands in the JSON; empty: this page is the last.
  std::string next_page_token;
};

/// The rows of an answer of ours, a JSON object that begins with its list (view/list_text.h);
/// nothing for any other. A newline between the parts of a row, as a robot may have written it,
/// becomes a space.
[[nodiscard]] std::optional<RowLines> LinesOfList(std::string_view json);

}  // namespace uplink::http
