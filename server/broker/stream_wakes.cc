#include "server/broker/stream_wakes.h"

#include <algorithm>

namespace uplink::broker {

void StreamWakes::Wake(std::uint64_t stream) {
  {
    const std::lock_guard lock(mutex_);
    woken_.push_back(stream);
    if (woken_.size() > 1) return;
  }
  look_();
}

std::vector<std::uint64_t> StreamWakes::Take() {
  std::vector<std::uint64_t> woken;
  {
    const std::lock_guard lock(mutex_);
    woken.swap(woken_);
  }
  std::ranges::sort(woken);
  woken.erase(std::unique(woken.begin(), woken.end()), woken.end());
  return woken;
}

}  // namespace uplink::broker
