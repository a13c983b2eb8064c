#pragma once

#include <cstddef>
#include <cstdint>

// What the server writes of itself: metrics and log. Defaults as in config.h.
namespace uplink::config {

struct MetricsConfig {
  /// Fleets that /metrics names; the others count as one.
  std::size_t fleets_max = 50;
};

enum class LogFormat : std::uint8_t { kText, kJson };
/// The least severe line that is written.
enum class LogLevel : std::uint8_t { kDebug, kInfo, kWarn, kError };

struct LogConfig {
  LogFormat format = LogFormat::kText;
  LogLevel level = LogLevel::kInfo;
};

}  // namespace uplink::config
