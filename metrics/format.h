#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::metrics {

/// How a scrape is written.
enum class Format : std::uint8_t {
  /// Prometheus text format 0.0.4.
  kText,
  /// OpenMetrics text format 1.0.0.
  kOpenMetrics,
};

/// How a text is carried.
enum class Coding : std::uint8_t { kPlain, kGzip };

/// The media type of a text in this format.
[[nodiscard]] constexpr std::string_view MediaType(Format format) {
  return format == Format::kText ? "text/plain; version=0.0.4; charset=utf-8"
                                 : "application/openmetrics-text; version=1.0.0; charset=utf-8";
}

/// Appends a label's value with `\`, `"` and newline escaped, as both formats want it.
void AppendEscaped(std::string& text, std::string_view value);

}  // namespace uplink::metrics
