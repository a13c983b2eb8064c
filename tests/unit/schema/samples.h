#pragma once

#include <vector>

#include "schema/model/record.h"

/// One good message of each variant, with every field filled.
namespace uplink::test {

inline constexpr std::int64_t kSampleMs = 1'763'683'200'000;

[[nodiscard]] inline model::Pose SamplePose() {
  return {.lat_deg = 47.25, .lon_deg = 8.5, .altitude_m = 410, .heading_deg = 90};
}

[[nodiscard]] inline model::MotionTelemetry SampleMotion() {
  return {.unix_time_ms = kSampleMs,
          .pose = SamplePose(),
          .velocity = model::VelTwist{.linear_mps = 1.5F, .angular_rps = -0.25F},
          .gps_fix_type = model::GpsFixType::kFixedRtk,
          .gps_source = model::GpsSource::kSimulated};
}

[[nodiscard]] inline model::StatusTelemetry SampleStatus() {
  model::StatusTelemetry status;
  status.unix_time_ms = kSampleMs;
  status.battery = model::BatteryStatus{.soc_pct = 80,
                                        .voltage_v = 48,
                                        .current_a = -2,
                                        .charge_ah = 30,
                                        .capacity_ah = 40,
                                        .design_capacity_ah = 42,
                                        .temperature = 20};
  status.mode = model::RobotMode::kAuto;
  status.estop = model::EStop{.unix_time_ms = kSampleMs, .active = true, .ids = {"front", "rear"}};
  status.faulted = true;
  status.mission_active = true;
  status.status = "mowing";
  status.fuel = model::FuelStatus{.level_pct = 60,
                                  .volume_remaining = 12,
                                  .capacity = 20,
                                  .volume_unit = "l",
                                  .efficiency = 4,
                                  .efficiency_unit = "l/h",
                                  .is_refueling = true};
  status.range_remaining = 1200;
  status.runtime_remaining = 3600;
  return status;
}

[[nodiscard]] inline model::TelemetryExtras SampleExtras() {
  return {.unix_time_ms = kSampleMs,
          .kv = {{.key = "rpm", .value = std::int32_t{3120}, .unix_time_ms = kSampleMs},
                 {.key = "temp", .value = 64.5, .unix_time_ms = {}},
                 {.key = "ok", .value = true, .unix_time_ms = {}},
                 {.key = "note", .value = std::string("fine"), .unix_time_ms = {}},
                 {.key = "gear", .value = model::EnumName{"low"}, .unix_time_ms = {}}}};
}

[[nodiscard]] inline model::SystemHealth SampleHealth() {
  return {.unix_time_ms = kSampleMs,
          .device_id = "cpu1",
          .cpu_pct = 10,
          .mem_pct = 20,
          .disk_pct = 30,
          .cpu_temp = 60,
          .signal_strength = -67,
          .signal_quality = 0.5F};
}

[[nodiscard]] inline model::UsageTelemetry SampleUsage() {
  return {.unix_time_ms = kSampleMs,
          .total_distance_m = 1000,
          .auto_distance_m = 900,
          .manual_distance_m = 100,
          .uptime_total_s = 5000,
          .drive_time_total_s = 4000,
          .auto_time_total_s = 3000,
          .mission_count_total = 7,
          .charge_cycles_total = 8,
          .reboot_count = 9,
          .last_reboot_unix_time_ms = kSampleMs};
}

[[nodiscard]] inline model::ConsumableStatus SampleConsumable() {
  return {.unix_time_ms = kSampleMs,
          .kind = "water",
          .tank_id = "main",
          .level_pct = 50,
          .amount_remaining = 12,
          .unit = "l",
          .is_critical = true};
}

[[nodiscard]] inline model::SpatialDirectiveStatus SampleDirective() {
  return {.directive_id = "zone-1",
          .last_eval_time_ms = kSampleMs,
          .active = true,
          .inside_zone = true,
          .distance_to_zone_m = 3};
}

[[nodiscard]] inline model::AgentInfo SampleAgentInfo() {
  return {.agent_version = "0.1.0",
          .software_version = "2025.11",
          .os_info = "Debian 12",
          .uptime_s = 86'400};
}

[[nodiscard]] inline model::MissionRunStatus SampleMission() {
  model::MissionRunStatus mission;
  mission.unix_time_ms = kSampleMs;
  mission.mission_id = "mission-1";
  mission.run_id = "run-1";
  mission.status = model::MissionStatus::kRunning;
  mission.status_message = "row 3 of 9";
  mission.progress_x100 = 3333;
  mission.current_path_id = "path-1";
  mission.current_target = SamplePose();
  mission.current_step = 3;
  mission.total_steps = 9;
  mission.time_started_ms = kSampleMs - 1000;
  mission.expected_end_time_ms = kSampleMs + 1000;
  mission.time_completed_ms = kSampleMs + 2000;
  mission.name = "south";
  return mission;
}

[[nodiscard]] inline model::Fault SampleFault() {
  return {.unix_time_ms = kSampleMs,
          .fault_id = "BATTERY_UNDERVOLT",
          .source = "bms",
          .severity = model::FaultSeverity::kMajor,
          .active = true,
          .category = "power",
          .description = "cell voltage low",
          .suggested_action = "charge"};
}

[[nodiscard]] inline model::EventTelemetry SampleEvent() {
  return {.unix_time_ms = kSampleMs,
          .kind = model::FaultRaisedEvent{.fault_code = "E1", .description = "hot"}};
}

[[nodiscard]] inline model::Message SampleMessage() {
  return {.unix_time_ms = kSampleMs, .level = model::MessageLevel::kWarn, .message = "hello"};
}

[[nodiscard]] inline model::Positions SampleRing(double offset = 0) {
  return {{.lon = 8 + offset, .lat = 47},
          {.lon = 8.5 + offset, .lat = 47},
          {.lon = 8.5 + offset, .lat = 47.5},
          {.lon = 8 + offset, .lat = 47}};
}

[[nodiscard]] inline model::ReportedShape SampleShape() {
  return {.identity = {.id = "shape-1", .name = "south", .rev = 3, .hash = "abc"},
          .data = model::PolygonData{.exterior = SampleRing(), .holes = {SampleRing(0.1)}},
          .area_type = model::ReportedLayerRole::kHazard,
          .scope = model::ScopeType::kFleet,
          .expire_time_ms = kSampleMs + 1000,
          .min_z_m = -1,
          .max_z_m = 2,
          .level_id = -2};
}

[[nodiscard]] inline model::Object SampleObject() {
  return {
      .id = "object-1",
      .name = "deer",
      .unix_time_ms = kSampleMs,
      .expires_unix_time_ms = kSampleMs + 1000,
      .scope = model::ScopeType::kWorld,
      .object_type = model::ObjectType::kAnimal,
      .location = SamplePose(),
      .trajectory = model::Trajectory{.speed_mps = 1, .course_deg = 10, .vertical_rate_mps = -0.5},
      .radius_m = 0.75};
}

[[nodiscard]] inline model::UiCapabilities SampleCapabilities() {
  model::UiCapabilities ui;
  ui.services = {{.name = "start",
                  .description = "begin",
                  .capability_type = model::CapabilityType::kSetBool,
                  .confirmation_message = "sure?",
                  .state_key = "blade",
                  .requires_role = model::Role::kOperator,
                  .danger_level = model::DangerLevel::kWarning}};
  ui.sensors = {{.key = "rpm",
                 .label = "Deck",
                 .value_type = model::ValueType::kInt,
                 .unit = "1/min",
                 .range = model::Range{.min = 0, .max = 5000},
                 .display_hint = model::DisplayHint::kGauge}};
  ui.settings = {{.key = "speed",
                  .label = "Speed",
                  .value_type = model::ValueType::kNumber,
                  .default_value = 1.5,
                  .range = model::Range{.min = 0, .max = 3},
                  .step = 0.5}};
  return ui;
}

[[nodiscard]] inline model::CurrentSettings SampleSettings() {
  return {.settings = {{.key = "speed", .value = 1.75},
                       {.key = "passes", .value = std::int32_t{4}},
                       {.key = "lights", .value = false},
                       {.key = "name", .value = std::string("r1")}}};
}

/// One of each, in the order of the union.
[[nodiscard]] inline std::vector<model::Body> SampleBodies() {
  return {SampleMission(),
          SampleMotion(),
          SampleStatus(),
          SampleExtras(),
          SampleEvent(),
          SampleCapabilities(),
          SampleFault(),
          model::ShapeOp{SampleShape()},
          model::ObjectOp{SampleObject()},
          SampleHealth(),
          SampleUsage(),
          SampleConsumable(),
          SampleSettings(),
          SampleMessage(),
          SampleAgentInfo(),
          SampleDirective()};
}

}  // namespace uplink::test
