#include "server/log/logger.h"

#include <chrono>
#include <cmath>

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

/// Values are printable UTF-8 already: only quotes and backslashes need care.
std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    quoted += c;
  }
  return quoted + '"';
}

std::string TextValue(const Field& field) {
  const bool plain =
      !field.value().empty() && field.value().find_first_of(" \"\\=") == std::string::npos;
  return plain ? field.value() : Quoted(field.value());
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
    line += fmt::format(",{}:{}", Quoted(field.key()),
                        field.bare() ? field.value() : Quoted(field.value()));
  }
  return line + '}';
}

}  // namespace

Field::Field(std::string_view key, std::string_view text)
    : key_(key), value_(PrintableUtf8(text, kValueBytesMax)) {}

std::string Field::ToText(double value) {
  // JSON has no NaN or infinity; null says as much.
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
}

Logger::Logger(std::unique_ptr<LineSink> sink, const Clock& clock, Format format, Level level)
    : sink_(std::move(sink)), clock_(clock), format_(format), level_(level) {
  UPLINK_CHECK(sink_ != nullptr, "a logger needs a sink");
}

void Logger::Write(Level level, std::string_view event, std::span<const Field> fields) const {
  if (!Enabled(level)) {
    return;
  }
  const SystemTime now = clock_.System();
  switch (format_) {
    case Format::kText:
      sink_->Write(TextLine(level, event, fields, now));
      return;
    case Format::kJson:
      sink_->Write(JsonLine(level, event, fields, now));
      return;
  }
}

}  // namespace uplink::log
