#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "schema/base/clock.h"

namespace uplink::robot {

/// Lines about connections of one robot within a minute. The log has a line at each begin and each
/// end, so ten streams a minute, which do not wait (kStreamsPerMinuteMax), have all of theirs.
inline constexpr std::uint32_t kConnectionLinesMax = 20;
inline constexpr std::chrono::minutes kConnectionLinesSpan{1};

/// Bounds the log's lines about the connections of one robot. Thread-safe.
class ConnectionLines final {
 public:
  /// How many lines were left out before this one; empty: it is left out, too.
  [[nodiscard]] std::optional<std::uint32_t> Take(SteadyTime now) {
    const std::lock_guard lock(mutex_);
    if (lines_ == 0 || now - span_start_ >= kConnectionLinesSpan) {
      span_start_ = now;
      lines_ = 0;
    }
    if (lines_ >= kConnectionLinesMax) {
      ++left_out_;
      return std::nullopt;
    }
    ++lines_;
    return std::exchange(left_out_, 0);
  }

 private:
  std::mutex mutex_;
  SteadyTime span_start_;
  std::uint32_t lines_ = 0;
  std::uint32_t left_out_ = 0;
};

}  // namespace uplink::robot
