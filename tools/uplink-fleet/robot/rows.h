#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <google/protobuf/message.h>
#include <google/protobuf/struct.pb.h>

#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "uplink/v1/fleet.pb.h"

/// What a robot's message must look like in the fleet contract's messages, without what the server
/// adds (the robot's name, arrivals, first raise). Written beside the server's own mapping on
/// purpose: the fleet would not see what both left out. Pure; any thread.
namespace uplink::synthetic {

[[nodiscard]] v1::Fault RowOf(const model::Fault& fault);
[[nodiscard]] v1::Event RowOf(const model::EventTelemetry& event);
[[nodiscard]] v1::RobotMessage RowOf(const model::Message& message);
/// `expires_at_ms` is what the message names.
[[nodiscard]] v1::Shape RowOf(const model::ReportedShape& shape);
[[nodiscard]] v1::TrackedObject RowOf(const model::Object& object);

/// A stored row as RowOf would have made it: what the server added is taken away.
[[nodiscard]] v1::Fault Bare(v1::Fault row);
[[nodiscard]] v1::Event Bare(v1::Event row);
[[nodiscard]] v1::RobotMessage Bare(v1::RobotMessage row);
[[nodiscard]] v1::Shape Bare(v1::Shape row);
[[nodiscard]] v1::TrackedObject Bare(v1::TrackedObject row);

/// A live part, or what is kept of a report, as a Struct.
[[nodiscard]] google::protobuf::Struct PartOfBody(const model::Body& body);
template <typename Message>
[[nodiscard]] google::protobuf::Struct PartOf(const Message& message) {
  return PartOfBody(message);
}
[[nodiscard]] google::protobuf::Struct PartOf(const model::RcanState& state,
                                              const std::string& ruri);
/// Key to setting.
[[nodiscard]] google::protobuf::Struct PartOf(const model::CurrentSettings& settings);
/// Key to value and sample time.
[[nodiscard]] google::protobuf::Struct PartOf(
    const std::map<std::string, model::SensorReading>& extras);
/// Key to item.
template <typename Body>
[[nodiscard]] google::protobuf::Struct PartOf(const std::map<std::string, Body>& items) {
  google::protobuf::Struct part;
  for (const auto& [key, body] : items) {
    *(*part.mutable_fields())[key].mutable_struct_value() = PartOf(body);
  }
  return part;
}

/// The same bytes for equal messages, maps included.
[[nodiscard]] std::string Canonical(const google::protobuf::Message& message);
/// Never 0.
[[nodiscard]] std::uint64_t HashOf(std::string_view text);
/// Of Canonical.
[[nodiscard]] std::uint64_t HashOf(const google::protobuf::Message& message);
/// The message as one line of JSON, cut at `bytes_max`, for people.
[[nodiscard]] std::string Shown(const google::protobuf::Message& message,
                                std::size_t bytes_max = 160);

}  // namespace uplink::synthetic
