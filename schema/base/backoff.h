#pragma once

#include <cstdint>

#include "schema/base/clock.h"

namespace uplink {

/// How long to wait before a try is made again: a call to the store, a connection.
struct BackoffLimits {
  /// The longest first pause; at least 2 ms.
  milliseconds first{50};
  /// No pause is longer; at least `first`.
  milliseconds longest{5'000};
};

/// Exponential pauses with jitter: each lies in the upper half of a bound that doubles up to
/// `longest`, so that servers which lost one peer together do not return to it together.
///
/// Thread: confined to its owner.
class Backoff final {
 public:
  /// Limits that do not hold what they say are a mistake of ours and abort.
  explicit Backoff(const BackoffLimits& limits);

  /// The next pause. `random` is any evenly drawn number.
  [[nodiscard]] milliseconds Next(std::uint64_t random);
  /// The try succeeded: the next pause is a first one again.
  void Reset() { bound_ = limits_.first; }

 private:
  BackoffLimits limits_;
  milliseconds bound_;
};

}  // namespace uplink
