#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "server/log/logger.h"

namespace uplink::log {

/// Writes a bounded number of lines per span, for events that an outsider can trigger: a bad
/// handshake, a protocol error. The first line of the next span says how many were suppressed.
/// There is one object per event, held by the component that logs it.
///
/// Limits: `lines_max` lines in a span, which begins with its first line. Around the edge of two
///         spans there can be twice as many within the length of one.
/// Thread: thread-safe; the lock is not held while the line is written.
class RateLimited final {
 public:
  static constexpr std::uint32_t kLinesMax = 10;
  static constexpr std::chrono::seconds kSpan{10};

  explicit RateLimited(const Logger& logger, std::uint32_t lines_max = kLinesMax,
                       milliseconds span = kSpan)
      : logger_(logger), lines_max_(lines_max), span_(span) {}

  /// Writes the line, with suppressed=N if N were suppressed before it, or suppresses it. False if
  /// it was suppressed.
  bool Write(Level level, std::string_view event, Fields fields);

  /// Lines suppressed since the object was made.
  [[nodiscard]] std::uint64_t suppressed_total() const;

 private:
  const Logger& logger_;
  const std::uint32_t lines_max_;
  const milliseconds span_;

  mutable std::mutex mutex_;
  SteadyTime span_start_{};
  std::uint32_t lines_ = 0;
  std::uint64_t suppressed_ = 0;
  std::uint64_t suppressed_total_ = 0;
};

}  // namespace uplink::log
