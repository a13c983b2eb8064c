#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"

namespace uplink::uncrew {

/// What a call comes to: the contract's outcomes, and the ends without one. Closed.
enum class Outcome : std::uint8_t {
  kStored,
  kApplied,
  kSuperseded,
  kDuplicate,
  kRejected,
  /// The store did not confirm in time, the server drains, or another one has the drone.
  kUnavailable,
  /// The certificate may not speak for the drone, or a bound stands against the call.
  kRefused,
};
/// As labels of a metric.
inline constexpr auto kOutcomeWords = std::to_array<std::string_view>(
    {"stored", "applied", "superseded", "duplicate", "rejected", "unavailable", "refused"});
static_assert(kOutcomeWords.size() == static_cast<std::size_t>(Outcome::kRefused) + 1);

/// What a drone is told. A value.
struct Answer {
  Outcome outcome = Outcome::kApplied;
  /// Of kRejected.
  std::optional<model::Rejection> rejection{};
  /// Of one that is over its rate.
  milliseconds retry_after{0};
};

}  // namespace uplink::uncrew
