#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "metrics/ledger.h"
#include "schema/model/variants.h"

namespace uplink::metrics {

/// A kind of the ledger as metrics and views spell it.
[[nodiscard]] inline std::string_view KindText(std::size_t kind) {
  if (kind == kUnknownKind) return "unknown";
  return kind == kRcanKind ? "rcanRobotState" : model::ToText(static_cast<model::Variant>(kind));
}

/// Telemetry: kinds whose latest message is enough. What exceeds the robot's rate is superseded
/// undecoded.
inline constexpr auto kTelemetryKinds = std::to_array<std::size_t>(
    {static_cast<std::size_t>(model::Variant::kMotionTelemetry),
     static_cast<std::size_t>(model::Variant::kStatusTelemetry),
     static_cast<std::size_t>(model::Variant::kTelemetryExtras), kRcanKind});

[[nodiscard]] constexpr bool IsTelemetry(std::size_t kind) {
  for (const std::size_t each : kTelemetryKinds) {
    if (each == kind) return true;
  }
  return false;
}

}  // namespace uplink::metrics
