#pragma once

#include <string_view>

#include "schema/cyberwave/limits.h"
#include "schema/cyberwave/names.h"
#include "schema/cyberwave/reader.h"
#include "schema/cyberwave/topic.h"
#include "schema/model/cyberwave/body.h"

/// One function per topic, in the file of its family: the members of a message to the model, judged
/// on the way. What is wrong goes to the reader's violations, and what is returned then is not
/// used. Units and shapes are the model's. Where a topic may carry several kinds of message, it is
/// read by `ReadTelemetry` and `ReadEvent`, which keep the object's text and change it on the way.
namespace uplink::cyberwave {

[[nodiscard]] model::cyberwave::Position ReadPosition(Reader& in);
[[nodiscard]] model::cyberwave::Rotation ReadRotation(Reader& in);
[[nodiscard]] model::cyberwave::Scale ReadScale(Reader& in);
[[nodiscard]] model::cyberwave::Gps ReadGps(Reader& in);
[[nodiscard]] model::cyberwave::Joints ReadJointUpdate(Reader& in, const Names& prismatic);
[[nodiscard]] model::cyberwave::Joints ReadJointStates(Reader& in, const Names& prismatic);
[[nodiscard]] model::cyberwave::Metrics ReadMetrics(Reader& in);
/// Of the twin that the topic names.
[[nodiscard]] model::cyberwave::EdgeHealth ReadEdgeHealth(Reader& in,
                                                          const model::cyberwave::Uuid& twin);
[[nodiscard]] model::cyberwave::BatteryStatus ReadBatteryStatus(Reader& in);

/// True for a message of `telemetry` that is live: a report.
[[nodiscard]] bool IsReport(const Reader& in);
/// True for a message of `telemetry` that is a mark.
[[nodiscard]] bool IsMark(const Reader& in);
/// A Mark, an Event, a DriverLog or a Report.
[[nodiscard]] model::cyberwave::Body ReadTelemetry(Reader& in, boost::json::object& object);
/// True for an `event` that is live: a robot's state.
[[nodiscard]] bool IsRobotState(const Reader& in);
/// An Event or a Report.
[[nodiscard]] model::cyberwave::Body ReadEvent(Reader& in, boost::json::object& object);
[[nodiscard]] model::cyberwave::DriverLog ReadDriverLog(Reader& in, boost::json::object& object);

[[nodiscard]] model::cyberwave::RunStatus ReadNavigateStatus(Reader& in);
[[nodiscard]] model::cyberwave::RunStatus ReadMissionStatus(Reader& in);
/// Of the type that the topic names.
[[nodiscard]] model::cyberwave::ScopeUpdate ReadEnvironment(Reader& in, boost::json::object& object,
                                                            std::string_view type);
[[nodiscard]] model::cyberwave::ScopeUpdate ReadWorkflowRun(Reader& in,
                                                            boost::json::object& object);

[[nodiscard]] model::cyberwave::CommandHead ReadCommand(Reader& in);
[[nodiscard]] model::cyberwave::Ping ReadPing(Reader& in);

}  // namespace uplink::cyberwave
