#pragma once

#include <cstddef>
#include <string>

#include "schema/model/cyberwave/health.h"
#include "schema/model/cyberwave/reports.h"

namespace uplink::cyberwave {

/// What the allocator adds to each allocation, as in schema/model/held_bytes.
inline constexpr std::size_t kAllocationBytes = 16;

/// What a value holds in memory besides itself, in bytes.
[[nodiscard]] std::size_t HeldBytes(const std::string& text);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::Metric& metric);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::EdgeHealth& health);
[[nodiscard]] std::size_t HeldBytes(const model::cyberwave::Report& report);

}  // namespace uplink::cyberwave
