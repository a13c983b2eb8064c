#pragma once

#include <variant>

#include "schema/model/cyberwave/health.h"
#include "schema/model/cyberwave/joints.h"
#include "schema/model/cyberwave/observed.h"
#include "schema/model/cyberwave/pose.h"
#include "schema/model/cyberwave/reports.h"
#include "schema/model/cyberwave/runs.h"

namespace uplink::model::cyberwave {

/// What a message says, without its robot and time.
using Body = std::variant<Ignored, Position, Rotation, Scale, Joints, Metrics, EdgeHealth, Gps,
                          BatteryStatus, Report, Mark, Event, DriverLog, RunStatus, ScopeUpdate,
                          CommandHead, Commanded, Signalling, Media, Ping>;

}  // namespace uplink::model::cyberwave
