#include "tools/uplinkctl/show/csv.h"

#include <string_view>

#include <absl/strings/numbers.h>

#include "schema/base/utf8.h"

namespace uplink::ctl {
namespace {

/// A spreadsheet takes a text that begins so for a formula, and robots write texts.
bool IsFormula(const std::string& text) {
  constexpr std::string_view kBegins = "=+-@";
  double number = 0;
  return !text.empty() && kBegins.find(text.front()) != std::string_view::npos &&
         !absl::SimpleAtod(text, &number);
}

std::string FieldOf(std::string_view text) {
  std::string shown = PrintableUtf8(text, std::string::npos);
  if (IsFormula(shown)) shown.insert(0, 1, '\'');
  const bool plain = shown.find_first_of(",\"") == std::string::npos && !shown.starts_with(' ') &&
                     !shown.ends_with(' ');
  if (plain) return shown;
  std::string quoted = "\"";
  for (const char c : shown) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string CsvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    if (&field != fields.data()) line += ',';
    line += FieldOf(field);
  }
  return line + '\n';
}

}  // namespace uplink::ctl
