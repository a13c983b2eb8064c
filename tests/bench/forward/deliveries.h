#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "tests/bench/figures.h"
#include "tests/bench/forward/update.h"

namespace uplink::bench {

/// What all receivers of one server got of the updates that were published since Begin. Confined to
/// one thread.
class Deliveries final {
 public:
  explicit Deliveries(const Clock& clock) : clock_(clock) {}

  /// Forgets all; what was published before now does not count.
  void Begin() {
    since_ = clock_.Steady();
    waits_ms_.clear();
  }
  /// A receiver got a message. False if it carries no update.
  bool Note(std::string_view message) {
    const std::optional<SteadyTime> at = PublishedAt(message);
    if (!at) return false;
    if (*at >= since_) {
      waits_ms_.push_back(std::chrono::duration<double, std::milli>(clock_.Steady() - *at).count());
    }
    return true;
  }

  [[nodiscard]] std::size_t count() const { return waits_ms_.size(); }
  /// Milliseconds from publishing to delivery within which this share of them came; 0 for none.
  [[nodiscard]] double WaitOf(double share) const { return Quantile(waits_ms_, share); }

 private:
  const Clock& clock_;
  SteadyTime since_;
  std::vector<double> waits_ms_;
};

}  // namespace uplink::bench
