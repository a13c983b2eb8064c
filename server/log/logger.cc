#include "server/log/logger.h"

#include <cmath>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "server/log/line_text.h"

namespace uplink::log {
namespace {

/// The most bytes that follow the first one of a code point in UTF-8.
constexpr int kContinuationsMax = 3;

bool IsContinuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

/// The first bytes, at most `bytes_max`; of UTF-8 they end with a whole code point.
std::string_view Front(std::string_view bytes, std::size_t bytes_max) {
  if (bytes.size() <= bytes_max) return bytes;
  std::size_t end = bytes_max;
  for (int i = 0; i < kContinuationsMax && IsContinuation(bytes[end]); ++i) --end;
  return bytes.substr(0, end);
}

}  // namespace

Field::Field(std::string_view key, std::string_view text)
    : key_(key), text_(Front(text, kValueBytesMax)) {}

std::string Field::ToText(double value) {
  // JSON has no NaN or infinity.
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
}

Logger::Logger(std::unique_ptr<LineSink> sink, const Clock& clock, Format format, Level level)
    : sink_(std::move(sink)), clock_(clock), format_(format), level_(level) {
  UPLINK_CHECK(sink_ != nullptr, "a logger needs a sink");
}

void Logger::Write(Level level, std::string_view event, std::span<const Field> fields) const {
  if (!Enabled(level)) return;
  const Quiet quiet = quiet_.load();
  if (quiet != Quiet::kNone && level < Level::kWarn) return;
  std::string line = LineText(format_, level, event, fields, clock_.System());
  if (quiet == Quiet::kWarnings) {
    if (level == Level::kWarn && held_.Add(line)) return;
    WriteHeld();
  }
  sink_->Write(level, line);
}

void Logger::SetQuiet(Quiet quiet) {
  if (quiet == Quiet::kWarnings) held_.Begin();
  quiet_.store(quiet);
  if (quiet != Quiet::kWarnings) WriteHeld();
}

void Logger::WriteHeld() const {
  for (const std::string& line : held_.Take()) sink_->Write(Level::kWarn, line);
}

}  // namespace uplink::log
