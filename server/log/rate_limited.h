#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "server/log/logger.h"

namespace uplink::log {

/// Lets through a bounded number of lines a span, for events that an outsider can trigger: a bad
/// handshake, a protocol error. The next line after a silence says how many were kept back.
/// One object an event, held by the component that logs it.
///
/// Limits: `lines_max` lines in any span that begins with a line (a fixed window, so at most twice
///         that around its edge).
/// Thread: thread-safe; the lock is not held while the line is written.
class RateLimited final {
 public:
  static constexpr std::uint32_t kLinesMax = 10;
  static constexpr std::chrono::seconds kSpan{10};

  explicit RateLimited(const Logger& logger, std::uint32_t lines_max = kLinesMax,
                       milliseconds span = kSpan)
      : logger_(logger), lines_max_(lines_max), span_(span) {}

  /// Writes the line, with suppressed=N if N were kept back before it; or keeps it back. True
  /// unless it was kept back.
  bool Write(Level level, std::string_view event, Fields fields);

  /// Lines kept back since the object was made.
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
