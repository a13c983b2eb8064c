#include "server/http/row_lines.h"

#include <cstddef>

namespace uplink::http {
namespace {

/// Ends the name of a member and begins a list.
constexpr std::string_view kListBegins = "\":[";
constexpr std::string_view kToken = "\"nextPageToken\":\"";

/// The JSON behind the bracket that opens a list, read byte by byte.
class Rows {
 public:
  explicit Rows(std::string_view json) : json_(json) {}

  /// The rows as lines; then rest() is what follows the list.
  std::string Take() {
    std::string text;
    text.reserve(json_.size() + 1);
    while (at_ < json_.size()) {
      const char c = json_[at_++];
      if (in_string_) {
        text += c;
        if (c == '\\' && at_ < json_.size()) text += json_[at_++];
        if (c == '"') in_string_ = false;
        continue;
      }
      if (depth_ == 0 && c == ']') break;
      text += Outside(c);
    }
    if (!text.empty()) text += '\n';
    return text;
  }
  [[nodiscard]] std::string_view rest() const { return json_.substr(at_); }

 private:
  /// What a byte outside of strings becomes.
  char Outside(char c) {
    if (c == '"') in_string_ = true;
    if (c == '{' || c == '[') ++depth_;
    if (c == '}' || c == ']') --depth_;
    if (c == '\n' || c == '\r') return ' ';
    return depth_ == 0 && c == ',' ? '\n' : c;
  }

  std::string_view json_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  bool in_string_ = false;
};

}  // namespace

std::optional<RowLines> LinesOfList(std::string_view json) {
  if (!json.starts_with("{\"")) return std::nullopt;
  const std::size_t name_end = json.find('"', 2);
  if (name_end == std::string_view::npos ||
      json.substr(name_end, kListBegins.size()) != kListBegins) {
    return std::nullopt;
  }
  Rows rows(json.substr(name_end + kListBegins.size()));
  RowLines lines;
  lines.text = rows.Take();
  const std::size_t token = rows.rest().find(kToken);
  if (token != std::string_view::npos) {
    const std::string_view begins = rows.rest().substr(token + kToken.size());
    lines.next_page_token = begins.substr(0, begins.find('"'));
  }
  return lines;
}

}  // namespace uplink::http
