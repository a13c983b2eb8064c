#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"

namespace uplink::uncrew {

/// The outcome of a call: those of the contract, and ends without one. A closed list.
enum class Outcome : std::uint8_t {
  kStored,
  kApplied,
  kSuperseded,
  kDuplicate,
  kRejected,
  /// The store did not confirm in time, the server drains, or another one has the drone.
  kUnavailable,
  /// The certificate may not speak for the drone, or a bound is reached.
  kRefused,
};
/// As labels of a metric.
inline constexpr auto kOutcomeWords = std::to_array<std::string_view>(
    {"stored", "applied", "superseded", "duplicate", "rejected", "unavailable", "refused"});
static_assert(kOutcomeWords.size() == static_cast<std::size_t>(Outcome::kRefused) + 1);

/// The answer to a drone. A value.
struct Answer {
  Outcome outcome = Outcome::kApplied;
  /// With kRejected.
  std::optional<model::Rejection> rejection{};
  /// With kRejected for the rate.
  milliseconds retry_after{0};
};

}  // namespace uplink::uncrew
