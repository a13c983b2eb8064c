#include "server/relay/gate.h"

#include <fmt/format.h>

namespace uplink::relay {

absl::Status Gate::Enter() {
  const std::lock_guard lock(mutex_);
  if (closed_) return absl::UnavailableError("the server drains");
  if (streams_ >= streams_max_) {
    return absl::ResourceExhaustedError(
        fmt::format("the server admits no more streams: it has {}", streams_));
  }
  ++streams_;
  return absl::OkStatus();
}

void Gate::Leave() {
  const std::lock_guard lock(mutex_);
  --streams_;
  if (streams_ == 0) empty_.notify_all();
}

void Gate::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool Gate::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

std::size_t Gate::streams() const {
  const std::lock_guard lock(mutex_);
  return streams_;
}

bool Gate::WaitEmpty(milliseconds wait) const {
  std::unique_lock lock(mutex_);
  return empty_.wait_for(lock, wait, [this] { return streams_ == 0; });
}

}  // namespace uplink::relay
