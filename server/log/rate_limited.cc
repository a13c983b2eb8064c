#include "server/log/rate_limited.h"

#include <utility>
#include <vector>

namespace uplink::log {

bool RateLimited::Write(Level level, std::string_view event, Fields fields) {
  if (!logger_.Enabled(level)) {
    return true;
  }
  std::uint64_t kept_back = 0;
  {
    const SteadyTime now = logger_.clock().Steady();
    const std::lock_guard lock(mutex_);
    if (lines_ == 0 || now - span_start_ >= span_) {
      span_start_ = now;
      lines_ = 0;
    }
    if (lines_ >= lines_max_) {
      ++suppressed_;
      ++suppressed_total_;
      return false;
    }
    ++lines_;
    kept_back = std::exchange(suppressed_, 0);
  }
  std::vector<Field> all(fields);
  if (kept_back > 0) {
    all.emplace_back("suppressed", kept_back);
  }
  logger_.Write(level, event, std::span<const Field>(all));
  return true;
}

std::uint64_t RateLimited::suppressed_total() const {
  const std::lock_guard lock(mutex_);
  return suppressed_total_;
}

}  // namespace uplink::log
