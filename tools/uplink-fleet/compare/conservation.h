#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// What a page of metrics says came in, and what became of it, summed over everything but outcomes.
/// A value.
struct Conservation {
  std::uint64_t received = 0;
  std::uint64_t in_flight = 0;
  std::map<std::string, std::uint64_t> settled;

  [[nodiscard]] std::uint64_t Of(const std::string& outcome) const {
    const auto found = settled.find(outcome);
    return found == settled.end() ? 0 : found->second;
  }
  /// What became of all that was received, with what is still on its way.
  [[nodiscard]] std::uint64_t sum() const {
    std::uint64_t all = in_flight;
    for (const auto& [outcome, count] : settled) all += count;
    return all;
  }
  [[nodiscard]] bool holds() const { return received == sum(); }
};

/// Of messages from brokers; by outcome: stored, applied, superseded, duplicate, rejected, refused,
/// observed, ignored, blocked. Nothing if the page lacks one of the three metrics. Pure; any
/// thread.
[[nodiscard]] std::optional<Conservation> BrokerMessagesOn(std::string_view page);

/// The same of drones' calls, as the server's status tells it; nothing if that says nothing of
/// them.
[[nodiscard]] std::optional<Conservation> DroneMessagesIn(const v1::ServerStatus& status);

/// The same of the changes that were due to receivers; by outcome: written, coalesced, snapshot,
/// dropped. Pure; any thread.
[[nodiscard]] std::optional<Conservation> ForwardsOn(std::string_view page);

}  // namespace uplink::synthetic
