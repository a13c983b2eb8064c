#include "tools/uplink-fleet/compare/conservation.h"

#include <cmath>

#include "tools/uplink-fleet/compare/metrics_page.h"

namespace uplink::synthetic {
namespace {

/// The metrics of one law.
struct Names {
  std::string_view received;
  std::string_view settled;
  std::string_view in_flight;
};

std::uint64_t CountOf(const Sample& sample) {
  return static_cast<std::uint64_t>(std::llround(sample.value));
}

std::optional<Conservation> On(std::string_view page, const Names& names) {
  const auto received = SamplesOf(page, names.received);
  const auto settled = SamplesOf(page, names.settled);
  const auto in_flight = SamplesOf(page, names.in_flight);
  if (received.empty() || settled.empty() || in_flight.empty()) return std::nullopt;
  Conservation counts;
  for (const Sample& sample : received) counts.received += CountOf(sample);
  for (const Sample& sample : in_flight) counts.in_flight += CountOf(sample);
  for (const Sample& sample : settled) {
    counts.settled[std::string(sample.Label("outcome"))] += CountOf(sample);
  }
  return counts;
}

}  // namespace

std::optional<Conservation> BrokerMessagesOn(std::string_view page) {
  return On(page, {.received = "uplinkd_mqtt_messages_received_total",
                   .settled = "uplinkd_mqtt_messages_settled_total",
                   .in_flight = "uplinkd_mqtt_messages_in_flight"});
}

std::optional<Conservation> DroneMessagesIn(const v1::ServerStatus& status) {
  const auto source = status.messages_by_source().find("uncrew");
  if (source == status.messages_by_source().end()) return std::nullopt;
  Conservation counts;
  for (const auto& [name, count] : source->second.counts()) {
    const auto number = static_cast<std::uint64_t>(count);
    if (name == "received") {
      counts.received = number;
    } else if (name == "inFlight") {
      counts.in_flight = number;
    } else {
      counts.settled[name] = number;
    }
  }
  return counts;
}

std::optional<Conservation> ForwardsOn(std::string_view page) {
  return On(page, {.received = "uplinkd_forwards_due_total",
                   .settled = "uplinkd_forwards_settled_total",
                   .in_flight = "uplinkd_forwards_waiting"});
}

}  // namespace uplink::synthetic
