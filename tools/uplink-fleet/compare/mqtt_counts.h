#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::synthetic {

/// What a page of metrics says of messages from brokers, summed over everything but outcomes. A
/// value.
struct MqttCounts {
  std::uint64_t received = 0;
  std::uint64_t in_flight = 0;
  /// By outcome: stored, applied, superseded, duplicate, rejected, refused, observed, ignored.
  std::map<std::string, std::uint64_t> settled;

  /// What became of all that was received, with what is still on its way.
  [[nodiscard]] std::uint64_t sum() const {
    std::uint64_t all = in_flight;
    for (const auto& [outcome, count] : settled) all += count;
    return all;
  }
  [[nodiscard]] bool holds() const { return received == sum(); }
};

/// Nothing if the page lacks one of the three metrics. Pure; any thread.
[[nodiscard]] std::optional<MqttCounts> MqttCountsOf(std::string_view page);

}  // namespace uplink::synthetic
