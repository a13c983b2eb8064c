#include "tools/uplink-fleet/robot/rows.h"

#include <functional>
#include <type_traits>
#include <variant>

#include <boost/json.hpp>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/json_util.h>

#include "schema/base/check.h"
#include "schema/base/rfc3339.h"
#include "schema/json/geojson.h"
#include "schema/json/render.h"
#include "schema/model/enum_text.h"
#include "server/view/timestamps.h"

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

/// By way of text, so that a number is the double that a reader of the server's JSON gets.
Struct StructOf(const boost::json::object& object) {
  Struct made;
  const auto status =
      google::protobuf::util::JsonStringToMessage(boost::json::serialize(object), &made);
  UPLINK_CHECK(status.ok(), status.ToString());
  return made;
}

template <typename Row>
Row WithoutArrival(Row row) {
  row.clear_ruri();
  row.clear_received_at();
  return row;
}

}  // namespace

v1::Fault RowOf(const model::Fault& fault) {
  v1::Fault row;
  row.set_fault_id(fault.fault_id);
  row.set_source(fault.source);
  row.set_severity(model::EnumText(fault.severity));
  row.set_active(fault.active);
  row.set_category(fault.category);
  row.set_description(fault.description);
  row.set_suggested_action(fault.suggested_action);
  view::SetTimeMs(row, &v1::Fault::mutable_sampled_at, fault.unix_time_ms);
  return row;
}

v1::Event RowOf(const model::EventTelemetry& event) {
  v1::Event row;
  row.set_kind(std::string(model::EventKindText(event.kind)));
  *row.mutable_detail() = StructOf(json::RenderDetail(event.kind));
  view::SetTimeMs(row, &v1::Event::mutable_sampled_at, event.unix_time_ms);
  return row;
}

v1::RobotMessage RowOf(const model::Message& message) {
  v1::RobotMessage row;
  row.set_level(model::EnumText(message.level));
  row.set_message(message.message);
  view::SetTimeMs(row, &v1::RobotMessage::mutable_sampled_at, message.unix_time_ms);
  return row;
}

v1::Shape RowOf(const model::ReportedShape& shape) {
  v1::Shape row;
  row.set_id(shape.identity.id);
  row.set_name(shape.identity.name);
  row.set_rev(shape.identity.rev);
  row.set_hash(shape.identity.hash);
  row.set_area_type(model::EnumText(shape.area_type));
  row.set_scope(model::EnumText(shape.scope));
  *row.mutable_geometry() = StructOf(json::RenderGeometry(shape.data));
  view::SetTimeMs(row, &v1::Shape::mutable_expires_at, shape.expire_time_ms);
  row.set_min_z_m(shape.min_z_m);
  row.set_max_z_m(shape.max_z_m);
  row.set_level_id(shape.level_id);
  return row;
}

v1::TrackedObject RowOf(const model::Object& object) {
  v1::TrackedObject row;
  row.set_id(object.id);
  row.set_name(object.name);
  row.set_object_type(model::EnumText(object.object_type));
  row.set_scope(model::EnumText(object.scope));
  *row.mutable_location() = StructOf(json::Render(object.location));
  if (object.trajectory) *row.mutable_trajectory() = StructOf(json::Render(*object.trajectory));
  row.set_radius_m(object.radius_m);
  view::SetTimeMs(row, &v1::TrackedObject::mutable_sampled_at, object.unix_time_ms);
  view::SetTimeMs(row, &v1::TrackedObject::mutable_expires_at, object.expires_unix_time_ms);
  return row;
}

v1::Fault Bare(v1::Fault row) {
  row.clear_raised_at();
  return WithoutArrival(std::move(row));
}
v1::Event Bare(v1::Event row) {
  row.mutable_detail();  // an event that holds nothing may come without
  return WithoutArrival(std::move(row));
}
v1::RobotMessage Bare(v1::RobotMessage row) { return WithoutArrival(std::move(row)); }
v1::Shape Bare(v1::Shape row) { return WithoutArrival(std::move(row)); }
v1::TrackedObject Bare(v1::TrackedObject row) { return WithoutArrival(std::move(row)); }

Struct PartOfBody(const model::Body& body) {
  return std::visit(
      []<typename Body>(const Body& member) {
        if constexpr (std::is_same_v<Body, model::CurrentSettings>) {
          return PartOf(member);
        } else {
          return StructOf(json::Render(member));
        }
      },
      body);
}

Struct PartOf(const model::RcanState& state, const std::string& ruri) {
  return StructOf(json::Render(state, ruri));
}

Struct PartOf(const model::CurrentSettings& settings) {
  boost::json::object by_key;
  for (const model::SettingUpdate& setting : settings.settings) {
    by_key[setting.key] = json::Render(setting.value);
  }
  return StructOf(by_key);
}

Struct PartOf(const std::map<std::string, model::SensorReading>& extras) {
  boost::json::object by_key;
  for (const auto& [key, reading] : extras) {
    boost::json::object shown{{"value", json::Render(reading.value)}};
    const std::int64_t sampled_ms = reading.unix_time_ms.value_or(0);
    if (sampled_ms != 0) shown["sampledAt"] = Rfc3339(FromUnixMs(sampled_ms));
    by_key[key] = std::move(shown);
  }
  return StructOf(by_key);
}

std::string Canonical(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&coded);
  }
  return bytes;
}

std::uint64_t HashOf(std::string_view text) {
  const std::uint64_t hash = std::hash<std::string_view>()(text);
  return hash == 0 ? 1 : hash;
}

std::uint64_t HashOf(const google::protobuf::Message& message) {
  return HashOf(std::string_view(Canonical(message)));
}

std::string Shown(const google::protobuf::Message& message, std::size_t bytes_max) {
  std::string json;
  if (!google::protobuf::util::MessageToJsonString(message, &json).ok()) return "?";
  if (json.size() > bytes_max) json = json.substr(0, bytes_max) + "...";
  return json;
}

}  // namespace uplink::synthetic
