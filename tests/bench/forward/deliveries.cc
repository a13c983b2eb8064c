#include "tests/bench/forward/deliveries.h"

#include <algorithm>
#include <optional>

#include "tests/bench/forward/update.h"

namespace uplink::bench {

void Deliveries::Begin() {
  since_ = clock_.Steady();
  waits_ms_.clear();
}

bool Deliveries::Note(std::string_view message) {
  const std::optional<SteadyTime> at = PublishedAt(message);
  if (!at) return false;
  if (*at >= since_) {
    waits_ms_.push_back(std::chrono::duration<float, std::milli>(clock_.Steady() - *at).count());
  }
  return true;
}

double Deliveries::WaitOf(double share) {
  if (waits_ms_.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(waits_ms_.size() - 1));
  const auto at = waits_ms_.begin() + place;
  std::nth_element(waits_ms_.begin(), at, waits_ms_.end());
  return *at;
}

}  // namespace uplink::bench
