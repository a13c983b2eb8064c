#include "schema/model/cyberwave/reports.h"

#include <array>

namespace uplink::model::cyberwave {

std::string_view ToText(MarkKind kind) {
  switch (kind) {
    case MarkKind::kConnected:
      return "connected";
    case MarkKind::kTelemetryStart:
      return "telemetry_start";
    case MarkKind::kTelemetryEnd:
      return "telemetry_end";
    case MarkKind::kDisconnected:
      return "disconnected";
    case MarkKind::kInitialObservation:
      return "initial_observation";
  }
  return "";
}

std::optional<MarkKind> MarkKindFromText(std::string_view text) {
  constexpr std::array kMarks = {MarkKind::kConnected, MarkKind::kTelemetryStart,
                                 MarkKind::kTelemetryEnd, MarkKind::kDisconnected,
                                 MarkKind::kInitialObservation};
  for (const MarkKind kind : kMarks) {
    if (ToText(kind) == text) return kind;
  }
  return std::nullopt;
}

}  // namespace uplink::model::cyberwave
