#include "server/broker/filters.h"

#include <utility>

namespace uplink::broker {

std::vector<mqtt::Filter> FiltersOf(cyberwave::Connection connection,
                                    const std::vector<std::string>& prefixes) {
  std::vector<mqtt::Filter> filters;
  const mqtt::Qos qos = connection == cyberwave::Connection::kDurable ? mqtt::Qos::kAtLeastOnce
                                                                      : mqtt::Qos::kAtMostOnce;
  for (const std::string& prefix : prefixes) {
    for (std::string& topic : cyberwave::Filters(prefix, connection)) {
      filters.push_back({.topic = std::move(topic), .qos = qos});
    }
  }
  return filters;
}

}  // namespace uplink::broker
