#include "server/log/line_text.h"

#include <algorithm>
#include <chrono>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "schema/base/check.h"
#include "schema/base/utf8.h"

namespace uplink::log {
namespace {

std::string_view LevelText(Level level) {
  switch (level) {
    case Level::kDebug:
      return "debug";
    case Level::kInfo:
      return "info";
    case Level::kWarn:
      return "warn";
    case Level::kError:
      return "error";
  }
  CheckFailed(__FILE__, __LINE__, "level", "a log level that does not exist");
}

std::string TimeText(SystemTime time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                     (time - seconds).count());
}

/// Quotes and backslashes.
void AppendEscaped(std::string_view text, std::string& to) {
  for (const char c : text) {
    if (c == '"' || c == '\\') to += '\\';
    to += c;
  }
}

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  AppendEscaped(text, quoted);
  return quoted + '"';
}

std::string TextValue(const Field& field) {
  if (field.bare()) return field.text();
  // First, since the backslashes of bytes shown as hex must not be escaped.
  std::string escaped;
  AppendEscaped(field.text(), escaped);
  std::string value = PrintableUtf8(escaped, std::string::npos);
  const bool plain = !value.empty() && value.find_first_of(" \"\\=") == std::string::npos;
  return plain ? value : '"' + value + '"';
}

/// Whether this is a control character of ASCII. JSON needs no escape for U+007F, but a terminal
/// acts on it.
bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7F'; }

std::string JsonEscape(char control) {
  switch (control) {
    case '\t':
      return "\\t";
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    default:
      return fmt::format("\\u{:04x}", static_cast<unsigned char>(control));
  }
}

/// Shows control characters by JSON's own escapes, so that a reader gets the original back. Bytes
/// that are not text, and marks that steer a terminal, are shown as in a text line.
std::string JsonValue(const Field& field) {
  if (field.bare()) return field.text();
  std::string value = "\"";
  std::string_view rest = field.text();
  while (!rest.empty()) {
    const auto control = std::ranges::find_if(rest, IsControl);
    const std::string_view plain(rest.begin(), control);
    AppendEscaped(PrintableUtf8(plain, std::string::npos), value);
    rest.remove_prefix(plain.size());
    if (rest.empty()) break;
    value += JsonEscape(rest.front());
    rest.remove_prefix(1);
  }
  return value + '"';
}

std::string TextLine(Level level, std::string_view event, std::span<const Field> fields,
                     SystemTime time) {
  std::string line = fmt::format("{} {} {}", TimeText(time), LevelText(level), event);
  for (const Field& field : fields) {
    line += fmt::format(" {}={}", field.key(), TextValue(field));
  }
  return line;
}

std::string JsonLine(Level level, std::string_view event, std::span<const Field> fields,
                     SystemTime time) {
  std::string line = fmt::format(R"({{"time":"{}","level":"{}","event":{})", TimeText(time),
                                 LevelText(level), Quoted(event));
  for (const Field& field : fields) {
    line += fmt::format(",{}:{}", Quoted(field.key()), JsonValue(field));
  }
  return line + '}';
}

}  // namespace

std::string LineText(Format format, Level level, std::string_view event,
                     std::span<const Field> fields, SystemTime time) {
  switch (format) {
    case Format::kText:
      return TextLine(level, event, fields, time);
    case Format::kJson:
      return JsonLine(level, event, fields, time);
  }
  CheckFailed(__FILE__, __LINE__, "format", "a log format that does not exist");
}

}  // namespace uplink::log
