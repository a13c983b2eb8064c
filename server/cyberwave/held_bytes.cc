#include "server/cyberwave/held_bytes.h"

#include <variant>

namespace uplink::cyberwave {

std::size_t HeldBytes(const std::string& text) {
  // A short one lies within the string.
  constexpr std::size_t kShort = sizeof(std::string) / 2;
  return text.capacity() < kShort ? 0 : text.capacity() + 1 + kAllocationBytes;
}

std::size_t HeldBytes(const model::cyberwave::Metric& metric) {
  const auto* text = std::get_if<std::string>(&metric.value);
  return HeldBytes(metric.category) + HeldBytes(metric.name) +
         (text == nullptr ? 0 : HeldBytes(*text));
}

std::size_t HeldBytes(const model::cyberwave::EdgeHealth& health) {
  std::size_t held = HeldBytes(health.edge_id) + kAllocationBytes +
                     health.streams.capacity() * sizeof(model::cyberwave::EdgeStream);
  for (const auto& stream : health.streams) {
    held += HeldBytes(stream.id) + HeldBytes(stream.camera_id) +
            HeldBytes(stream.connection_state) + HeldBytes(stream.ice_connection_state);
  }
  return held;
}

std::size_t HeldBytes(const model::cyberwave::Report& report) {
  return HeldBytes(report.name) + HeldBytes(report.detail);
}

}  // namespace uplink::cyberwave
