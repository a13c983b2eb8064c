#pragma once

#include <cstddef>

#include "schema/model/record.h"
#include "schema/rules/faults.h"
#include "schema/uplink.capnp.h"

/// One function per variant, in the file of its family: reads the member's struct into the model
/// and judges it on the way, in schema order. What it returns is fit to keep unless `faults` says
/// that the message is rejected. They may throw kj::Exception (a pointer that leads nowhere);
/// schema/judge.cc catches it.
namespace uplink::schema {

// decode/motion.cc, decode/status.cc, decode/extras.cc
[[nodiscard]] model::MotionTelemetry DecodeMotion(wire::MotionTelemetry::Reader in, Faults& faults);
[[nodiscard]] model::StatusTelemetry DecodeStatus(wire::StatusTelemetry::Reader in, Faults& faults);
[[nodiscard]] model::TelemetryExtras DecodeExtras(wire::TelemetryExtras::Reader in, Faults& faults,
                                                  std::size_t items_max);

// decode/mission.cc
[[nodiscard]] model::MissionRunStatus DecodeMission(wire::MissionRunStatus::Reader in,
                                                    Faults& faults);

// decode/reports.cc
[[nodiscard]] model::Fault DecodeFault(wire::Fault::Reader in, Faults& faults);
[[nodiscard]] model::EventTelemetry DecodeEvent(wire::EventTelemetry::Reader in, Faults& faults);
[[nodiscard]] model::Message DecodeMessage(wire::Message::Reader in, Faults& faults);

// decode/spatial.cc
[[nodiscard]] model::ShapeOp DecodeShape(wire::ReportedShapeOp::Reader in, Faults& faults);
[[nodiscard]] model::ObjectOp DecodeObject(wire::ObjectOp::Reader in, Faults& faults);

// decode/health.cc
[[nodiscard]] model::SystemHealth DecodeHealth(wire::SystemHealth::Reader in, Faults& faults);
[[nodiscard]] model::UsageTelemetry DecodeUsage(wire::UsageTelemetry::Reader in, Faults& faults);
[[nodiscard]] model::ConsumableStatus DecodeConsumable(wire::ConsumableStatus::Reader in,
                                                       Faults& faults);
[[nodiscard]] model::SpatialDirectiveStatus DecodeDirective(wire::SpatialDirectiveStatus::Reader in,
                                                            Faults& faults);
[[nodiscard]] model::AgentInfo DecodeAgentInfo(wire::AgentInfo::Reader in, Faults& faults);

// decode/capabilities.cc
[[nodiscard]] model::UiCapabilities DecodeCapabilities(wire::UiCapabilities::Reader in,
                                                       Faults& faults);
[[nodiscard]] model::CurrentSettings DecodeSettings(capnp::List<wire::SettingUpdate>::Reader in,
                                                    Faults& faults);

}  // namespace uplink::schema
