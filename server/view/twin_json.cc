#include "server/view/twin_json.h"

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "schema/base/rfc3339.h"
#include "schema/json/exact.h"
#include "schema/json/fields.h"

namespace uplink::view {
namespace {

namespace cw = model::cyberwave;
namespace js = boost::json;
using cyberwave::Held;
using cyberwave::Stamp;
using json::Fields;

constexpr double kUsPerSecond = 1e6;

double Seconds(std::int64_t us) { return static_cast<double>(us) / kUsPerSecond; }

void SetText(Fields& fields, std::string_view name, const std::string& text) {
  if (!text.empty()) fields.Set(name, text);
}

void SetStamp(Fields& fields, const Stamp& stamp) {
  if (stamp.timestamp_us != 0) fields.Set("timestamp", Seconds(stamp.timestamp_us));
  fields.Set("receivedAt", Rfc3339(stamp.arrived.system));
}

void SetSource(Fields& fields, const cw::Source& source) {
  fields.Set("source_type",
             source.text.empty() ? std::string(cw::ToText(source.type)) : source.text);
}

// One overload for each kind of value.
Fields Render(const cw::Position& position) {
  return std::move(Fields().Set("x", position.x_m).Set("y", position.y_m).Set("z", position.z_m));
}
Fields Render(const cw::Rotation& rotation) {
  return std::move(
      Fields().Set("w", rotation.w).Set("x", rotation.x).Set("y", rotation.y).Set("z", rotation.z));
}
Fields Render(const cw::Scale& scale) {
  return std::move(Fields().Set("x", scale.x).Set("y", scale.y).Set("z", scale.z));
}
Fields Render(const cw::Gps& gps) {
  Fields fields;
  fields.SetIf("latitude", gps.latitude_deg)
      .SetIf("longitude", gps.longitude_deg)
      .SetIf("altitude", gps.altitude_m)
      .SetIf("compass_heading", gps.compass_heading_deg)
      .SetIf("horizontal_accuracy", gps.horizontal_accuracy_m)
      .SetIf("vertical_accuracy", gps.vertical_accuracy_m)
      .SetIf("satellite_count", gps.satellite_count)
      .SetIf("signal_level", gps.signal_level);
  SetText(fields, "fix_type", gps.fix_type);
  return fields;
}
Fields Render(const cw::BatteryStatus& battery) {
  return std::move(Fields()
                       .SetIf("percentage", battery.percentage)
                       .SetIf("voltage", battery.voltage_v)
                       .SetIf("charging", battery.charging));
}
Fields Render(const cw::EdgeStream& stream) {
  Fields fields;
  SetText(fields, "camera_id", stream.camera_id);
  SetText(fields, "connection_state", stream.connection_state);
  SetText(fields, "ice_connection_state", stream.ice_connection_state);
  fields.SetIf("frames_sent", stream.frames_sent);
  if (stream.last_frame_us != 0) fields.Set("last_frame_ts", Seconds(stream.last_frame_us));
  fields.SetIf("fps", stream.fps)
      .SetIf("uptime_seconds", stream.uptime_s)
      .SetIf("restart_count", stream.restart_count)
      .SetIf("is_stale", stream.is_stale)
      .SetIf("is_healthy", stream.is_healthy);
  return fields;
}
Fields Render(const cw::EdgeHealth& health) {
  Fields streams;
  for (const cw::EdgeStream& stream : health.streams) streams.Set(stream.id, Render(stream).Take());
  return std::move(Fields()
                       .SetIf("uptime_seconds", health.uptime_s)
                       .Set("streams", streams.Take())
                       .SetIf("stream_count", health.stream_count)
                       .SetIf("healthy_streams", health.healthy_streams)
                       .SetIf("host_memory_percent", health.host_memory_percent)
                       .SetIf("host_cpu_percent", health.host_cpu_percent)
                       .SetIf("host_disk_percent", health.host_disk_percent)
                       .SetIf("cpu_temp_c", health.cpu_temp_c));
}
Fields Render(const cw::Report& report) {
  Fields fields;
  // The judge wrote the detail, so it always parses.
  if (std::optional<js::value> detail = json::ParseExact(report.detail)) {
    fields.Set("data", *std::move(detail));
  }
  return fields;
}

template <typename T>
js::object RenderHeld(const Held<T>& held) {
  Fields fields = Render(held.value);
  SetSource(fields, held.source);
  SetStamp(fields, held.stamp);
  return fields.Take();
}

template <typename T>
void SetHeld(Fields& fields, std::string_view name, const std::optional<Held<T>>& held) {
  if (held) fields.Set(name, RenderHeld(*held));
}

template <typename Table>
void SetTable(Fields& fields, std::string_view name, const Table& table) {
  if (table.size() == 0) return;
  Fields by_key;
  for (const auto& [key, sized] : table.items()) by_key.Set(key, RenderHeld(sized.value));
  fields.Set(name, by_key.Take());
}

js::object RenderJoint(const cyberwave::HeldJoint& joint) {
  Fields fields;
  fields.SetIf("position", joint.position)
      .SetIf("velocity", joint.velocity)
      .SetIf("effort", joint.effort);
  if (joint.prismatic) fields.Set("prismatic", true);
  SetText(fields, "source_type", joint.other_source);
  SetStamp(fields, joint.stamp);
  return fields.Take();
}

void SetJoints(Fields& fields, const cyberwave::JointTable& joints) {
  Fields by_source;
  bool any = false;
  for (std::size_t i = 0; i < cyberwave::kJointGroups; ++i) {
    const auto group = static_cast<cyberwave::JointGroup>(i);
    if (joints.Of(group).empty()) continue;
    Fields by_name;
    for (const auto& [name, joint] : joints.Of(group)) by_name.Set(name, RenderJoint(joint));
    by_source.Set(ToText(group), by_name.Take());
    any = true;
  }
  if (any) fields.Set("joints", by_source.Take());
}

js::value RenderMetric(const cw::MetricValue& value) {
  return std::visit([](const auto& scalar) { return json::Json(scalar); }, value);
}

/// Metrics by category and name. A category that has a value itself is shown as that value.
void SetMetrics(Fields& fields, const cyberwave::TwinParts& parts) {
  if (parts.metrics.size() == 0) return;
  Fields by_category;
  for (const auto& [category, sized] : parts.metrics.items()) {
    Fields by_name;
    std::optional<js::value> whole;
    for (const cw::Metric& metric : sized.value.value) {
      if (metric.name.empty()) {
        whole = RenderMetric(metric.value);
      } else {
        by_name.Set(metric.name, RenderMetric(metric.value));
      }
    }
    by_category.Set(category, whole ? *std::move(whole) : js::value(by_name.Take()));
  }
  fields.Set("metrics", by_category.Take());
}

void SetSessions(Fields& fields, const cyberwave::SessionMarks& marks) {
  if (marks.sessions().empty()) return;
  Fields by_id;
  for (const auto& [id, session] : marks.sessions()) {
    Fields one;
    one.SetIf("connected", session.connected).SetIf("telemetry", session.telemetry);
    if (!session.ended_streams.empty()) {
      one.Set("endedStreams", json::ListOf(session.ended_streams,
                                           [](const std::string& stream) { return stream; }));
    }
    one.Set("lastMark", std::string(cw::ToText(session.last)));
    SetStamp(one, session.stamp);
    by_id.Set(id, one.Take());
  }
  fields.Set("sessions", by_id.Take());
}

void SetLastCommand(Fields& fields, const std::optional<cyberwave::LastCommand>& command) {
  if (!command) return;
  Fields head;
  head.Set("topic", std::string(ToText(command->topic)));
  SetText(head, "command", command->head.command);
  SetText(head, "status", command->head.status);
  SetText(head, "action_id", command->head.action_id);
  SetText(head, "source_type", command->source.text);
  SetStamp(head, command->stamp);
  fields.Set("lastCommand", head.Take());
}

void SetObserved(Fields& fields, const cyberwave::ObservedCounts& counts) {
  Fields media;
  Fields observed;
  bool any_media = false;
  bool any_observed = counts.setpoints() > 0;
  for (const cyberwave::TopicRow& row : cyberwave::TopicRows()) {
    if (const auto count = counts.media(row.kind); count.messages > 0) {
      media.Set(row.tail,
                Fields().Set("messages", count.messages).Set("bytes", count.bytes).Take());
      any_media = true;
    }
    if (const std::uint64_t count = counts.observed(row.kind); count > 0) {
      observed.Set(ToText(row.kind), count);
      any_observed = true;
    }
  }
  if (any_media) fields.Set("media", media.Take());
  if (counts.setpoints() > 0) observed.Set("setpoints", counts.setpoints());
  if (any_observed) fields.Set("observed", observed.Take());
}

}  // namespace

js::object TwinJson(const cyberwave::TwinParts& parts) {
  Fields fields;
  SetHeld(fields, "position", parts.position);
  SetHeld(fields, "rotation", parts.rotation);
  SetHeld(fields, "scale", parts.scale);
  SetJoints(fields, parts.joints);
  SetMetrics(fields, parts);
  SetTable(fields, "edgeHealth", parts.edges);
  SetHeld(fields, "gps", parts.gps);
  SetHeld(fields, "battery", parts.battery);
  SetHeld(fields, "motors", parts.motors);
  SetHeld(fields, "driverInfo", parts.driver_info);
  SetTable(fields, "reports", parts.reports);
  SetSessions(fields, parts.sessions);
  SetLastCommand(fields, parts.observed.last_command());
  SetObserved(fields, parts.observed);
  return fields.Take();
}

}  // namespace uplink::view
