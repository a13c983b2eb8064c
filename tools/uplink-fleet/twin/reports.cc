#include "tools/uplink-fleet/twin/reports.h"

#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

constexpr double kPercent = 100;
/// Errors that metrics name at once.
constexpr std::size_t kErrorsMax = 3;

}  // namespace

void Reports::Say(const Draft& draft, const std::string& path, js::object fields,
                  std::string_view source) {
  speech_.account.Live(Side::kReal, path, AsShown(draft, std::move(fields), source));
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
}

Draft Reports::BeginMetrics(js::object& metrics) {
  Seeded& chance = speech_.chance;
  // Metrics have no time.
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body.erase("timestamp");
  const js::object power{{"battery_percent", chance.Between(0, kPercent)},
                         {"voltage", chance.Between(22, 26)},
                         {"estimated_runtime_minutes", chance.Between(0, 240)}};
  const double cpu = chance.Between(0, kPercent);
  const double gpu = chance.Between(30, 90);
  metrics["power"] = power;
  metrics["load"] =
      js::object{{"cpu", cpu}, {"gpu", js::object{{"temperature", gpu}}}, {"throttled", gpu > 80}};
  speech_.account.Live(Side::kReal, "metrics/power", power);
  speech_.account.Live(Side::kReal, "metrics/load",
                       js::object{{"cpu", cpu}, {"gpu/temperature", gpu}, {"throttled", gpu > 80}});
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return draft;
}

void Reports::ChangeFaults(const Draft& draft, std::set<std::string> named) {
  for (const std::string& error : named) {
    if (!errors_.contains(error)) speech_.account.FaultChange(draft.number, {error, true});
  }
  for (const std::string& error : errors_) {
    if (!named.contains(error)) speech_.account.FaultChange(draft.number, {error, false});
  }
  errors_ = std::move(named);
}

Publication Reports::Metrics() {
  js::object metrics;
  Draft draft = BeginMetrics(metrics);
  ChangeFaults(draft, {});
  draft.body["metrics"] = std::move(metrics);
  return speech_.voice.ToTwin(draft, "metrics", Qos::k1);
}

Publication Reports::MetricsWithErrors() {
  js::object metrics;
  Draft draft = BeginMetrics(metrics);
  std::set<std::string> named;
  for (const std::string& error : errors_) {
    if (named.size() + 1 < kErrorsMax && speech_.chance.Chance(0.5)) named.insert(error);
  }
  named.insert("motor stalled " + speech_.voice.MarkOf(draft));
  js::array errors;
  for (const std::string& error : named) errors.emplace_back(error);
  ChangeFaults(draft, std::move(named));
  metrics["errors"] = std::move(errors);
  draft.body["metrics"] = std::move(metrics);
  return speech_.voice.ToTwin(draft, "metrics", Qos::k1);
}

Publication Reports::DriverHealth() {
  Seeded& chance = speech_.chance;
  const std::string& twin = speech_.voice.ids().twin;
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const js::object stream{{"camera_id", "front"},
                          {"connection_state", "connected"},
                          {"ice_connection_state", "connected"},
                          {"frames_sent", static_cast<std::int64_t>(chance.Below(100'000))},
                          {"fps", chance.Between(20, 30)},
                          {"uptime_seconds", chance.Between(0, 900)},
                          {"restart_count", 0},
                          {"is_stale", false},
                          {"is_healthy", true}};
  const js::object fields{{"uptime_seconds", chance.Between(0, 9000)},
                          {"streams", js::object{{"front", stream}}},
                          {"stream_count", 1},
                          {"healthy_streams", 1}};
  draft.body["type"] = "edge_health";
  draft.body["twin_uuid"] = twin;
  draft.body["edge_id"] = twin;
  for (const auto& field : fields) draft.body[field.key()] = field.value();
  Say(draft, "edgeHealth/" + twin, fields, "edge");
  return speech_.voice.ToTwin(draft, "edge_health", Qos::k0);
}

Publication Reports::ComputerHealth() {
  Seeded& chance = speech_.chance;
  const TwinIds& ids = speech_.voice.ids();
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const js::object fields{{"uptime_seconds", chance.Between(0, 90'000)},
                          {"streams", js::object()},
                          {"stream_count", 0},
                          {"healthy_streams", 0},
                          {"host_memory_percent", chance.Between(0, kPercent)},
                          {"host_cpu_percent", chance.Between(0, kPercent)},
                          {"host_disk_percent", chance.Between(0, kPercent)},
                          {"cpu_temp_c", chance.Between(30, 90)}};
  draft.body["twin_uuid"] = ids.twin;
  draft.body["edge_id"] = ids.computer;
  for (const auto& field : fields) draft.body[field.key()] = field.value();
  Say(draft, "edgeHealth/" + ids.computer, fields, "edge");
  return speech_.voice.ToTwin(draft, "edge_health", Qos::k0);
}

Publication Reports::MotorStatus() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["type"] = "motor_status";
  draft.body["motors"] = js::object{{"left", js::object{{"rpm", speech_.chance.Between(0, 90)}}}};
  Say(draft, "motors", {{"data", draft.body}}, "edge");
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Reports::DriverInfo() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["type"] = "driver_info";
  draft.body["version"] = fmt::format("1.{}", speech_.chance.Below(100));
  Say(draft, "driverInfo", {{"data", draft.body}}, "edge");
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Reports::BatteryReport() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["telemetry_type"] = "battery";
  const js::object data{{"level", speech_.chance.Between(0, kPercent)}, {"charging", false}};
  draft.body["data"] = data;
  Say(draft, "reports/battery", {{"data", data}}, "edge");
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Reports::RobotState() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["event_type"] = "robot_state";
  draft.body["source"] = "navigation";
  const js::object data{{"mode", "auto"}, {"speed", speech_.chance.Between(0, 2)}};
  draft.body["data"] = data;
  Say(draft, "reports/robot_state", {{"data", data}}, "edge");
  return speech_.voice.ToTwin(draft, "event", Qos::k1);
}

Publication Reports::BatteryStatus() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "");
  const js::object fields{{"percentage", speech_.chance.Between(2, kPercent)},
                          {"voltage", speech_.chance.Between(22, 26)}};
  for (const auto& field : fields) draft.body[field.key()] = field.value();
  Say(draft, "battery", fields, "edge");
  return speech_.voice.ToTwin(draft, "battery/status", Qos::k0);
}

Publication Reports::Command() {
  Draft draft = speech_.voice.Begin(Speaker::kViewer, "tele");
  draft.body["command"] = "start_video";
  draft.body["data"] = js::object{{"token", kSecret.data()}};
  // Its head alone is shown.
  speech_.account.Live(
      Side::kReal, "lastCommand",
      AsShown(draft, {{"topic", "twin/command"}, {"command", "start_video"}}, "tele"));
  return speech_.voice.ToTwin(draft, "command", Qos::k0);
}

Publication Reports::Signalling() {
  Draft draft = speech_.voice.Begin(Speaker::kViewer, "");
  draft.body["type"] = "candidate";
  draft.body["candidate"] = kSecret.data();
  return speech_.voice.ToTwin(draft, "webrtc-candidate", Qos::k0);
}

}  // namespace uplink::synthetic
