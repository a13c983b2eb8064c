#pragma once

#include <cstddef>
#include <string>

#include "schema/model/cyberwave/health.h"
#include "schema/model/cyberwave/reports.h"

namespace uplink::cyberwave {

/// The allocator's overhead per allocation, as in schema/model/held_bytes.
inline constexpr std::size_t kAllocationBytes = 16;

/// Bytes that a value holds in memory besides its own size.
[[nodiscard]] std::size_t HeldBytes(const std::string& text);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::Metric& metric);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::EdgeHealth& health);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::Report& report);

}  // namespace uplink::cyberwave
