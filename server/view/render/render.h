#pragma once

#include <google/protobuf/struct.pb.h>

#include "schema/model/record.h"

/// The model as JSON values, by the specification's names: absent optionals are absent, hasX flags
/// never appear, enumerants are names, a Value is its bare scalar, a void union member is null,
/// 32-bit floats are the double that they are. What is shown was judged before, so every number is
/// finite. Pure; any thread.
namespace uplink::view {

[[nodiscard]] google::protobuf::Struct Render(const model::MissionRunStatus& body);
[[nodiscard]] google::protobuf::Struct Render(const model::MotionTelemetry& body);
[[nodiscard]] google::protobuf::Struct Render(const model::StatusTelemetry& body);
[[nodiscard]] google::protobuf::Struct Render(const model::TelemetryExtras& body);
[[nodiscard]] google::protobuf::Struct Render(const model::EventTelemetry& body);
[[nodiscard]] google::protobuf::Struct Render(const model::UiCapabilities& body);
[[nodiscard]] google::protobuf::Struct Render(const model::Fault& body);
[[nodiscard]] google::protobuf::Struct Render(const model::ShapeOp& body);
[[nodiscard]] google::protobuf::Struct Render(const model::ObjectOp& body);
[[nodiscard]] google::protobuf::Struct Render(const model::SystemHealth& body);
[[nodiscard]] google::protobuf::Struct Render(const model::UsageTelemetry& body);
[[nodiscard]] google::protobuf::Struct Render(const model::ConsumableStatus& body);
/// The bare list of the specification; RenderByKey is what operators see.
[[nodiscard]] google::protobuf::ListValue Render(const model::CurrentSettings& body);
[[nodiscard]] google::protobuf::Struct Render(const model::Message& body);
[[nodiscard]] google::protobuf::Struct Render(const model::AgentInfo& body);
[[nodiscard]] google::protobuf::Struct Render(const model::SpatialDirectiveStatus& body);

/// The whole message: `{"motionTelemetry": {...}}`.
[[nodiscard]] google::protobuf::Struct RenderBody(const model::Body& body);

// Parts that views show on their own.
[[nodiscard]] google::protobuf::Struct Render(const model::Pose& pose);
[[nodiscard]] google::protobuf::Struct Render(const model::Trajectory& trajectory);
[[nodiscard]] google::protobuf::Value Render(const model::Value& value);
/// What the event's union member holds: Event.detail; empty for the e-stop kinds.
[[nodiscard]] google::protobuf::Struct RenderDetail(const model::EventKind& kind);
/// Key to value.
[[nodiscard]] google::protobuf::Struct RenderByKey(const model::CurrentSettings& settings);

}  // namespace uplink::view
