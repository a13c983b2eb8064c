#include "schema/model/record.h"

namespace uplink::model {

std::string_view ToText(Variant variant) {
  switch (variant) {
    case Variant::kMissionRunStatus:
      return "missionRunStatus";
    case Variant::kMotionTelemetry:
      return "motionTelemetry";
    case Variant::kStatusTelemetry:
      return "statusTelemetry";
    case Variant::kTelemetryExtras:
      return "telemetryExtras";
    case Variant::kEventTelemetry:
      return "eventTelemetry";
    case Variant::kUiCapabilities:
      return "uiCapabilities";
    case Variant::kFault:
      return "fault";
    case Variant::kShape:
      return "shape";
    case Variant::kObject:
      return "object";
    case Variant::kSystemHealth:
      return "systemHealth";
    case Variant::kUsageTelemetry:
      return "usageTelemetry";
    case Variant::kConsumableStatus:
      return "consumableStatus";
    case Variant::kCurrentSettings:
      return "currentSettings";
    case Variant::kMessage:
      return "message";
    case Variant::kAgentInfo:
      return "agentInfo";
    case Variant::kSpatialDirectiveStatus:
      return "spatialDirectiveStatus";
  }
  return "unknown";
}

bool IsDurable(Variant variant) {
  switch (variant) {
    case Variant::kMissionRunStatus:
    case Variant::kEventTelemetry:
    case Variant::kUiCapabilities:
    case Variant::kFault:
    case Variant::kShape:
    case Variant::kObject:
    case Variant::kCurrentSettings:
    case Variant::kMessage:
    case Variant::kAgentInfo:
      return true;
    case Variant::kMotionTelemetry:
    case Variant::kStatusTelemetry:
    case Variant::kTelemetryExtras:
    case Variant::kSystemHealth:
    case Variant::kUsageTelemetry:
    case Variant::kConsumableStatus:
    case Variant::kSpatialDirectiveStatus:
      return false;
  }
  return false;
}

}  // namespace uplink::model
