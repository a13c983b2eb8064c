#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::bench {

/// What all receivers of one server got of the updates that were published since Begin. Confined to
/// one thread.
class Deliveries final {
 public:
  explicit Deliveries(const Clock& clock) : clock_(clock) {}

  /// Forgets all; what was published before now does not count.
  void Begin();
  /// A receiver got a message. False if it carries no update.
  bool Note(std::string_view message);

  [[nodiscard]] std::size_t count() const { return waits_ms_.size(); }
  /// Milliseconds from publishing to delivery within which this share of them came; 0 for none.
  [[nodiscard]] double WaitOf(double share);

 private:
  const Clock& clock_;
  SteadyTime since_;
  std::vector<float> waits_ms_;
};

}  // namespace uplink::bench
