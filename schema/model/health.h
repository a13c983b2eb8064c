#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace uplink::model {

/// State of one computer of the robot; device_id is its key. An absent number was not measured
/// (NaN on the wire), or was dropped. Live. A value.
struct SystemHealth {
  std::int64_t unix_time_ms = 0;
  std::string device_id;
  /// 0 to 100, as the two below.
  std::optional<float> cpu_pct;
  std::optional<float> mem_pct;
  std::optional<float> disk_pct;
  /// Degrees Celsius.
  std::optional<float> cpu_temp;
  /// RSSI, dBm.
  std::optional<float> signal_strength;
  /// Link quality as the host reports it.
  std::optional<float> signal_quality;

  friend bool operator==(const SystemHealth&, const SystemHealth&) = default;
};

[[nodiscard]] inline std::string KeyOf(const SystemHealth& health) { return health.device_id; }

/// Counts since the robot was made; a number is absent only if judgement dropped it. Live. A value.
struct UsageTelemetry {
  std::int64_t unix_time_ms = 0;
  /// Metres.
  std::optional<double> total_distance_m;
  std::optional<double> auto_distance_m;
  std::optional<double> manual_distance_m;
  /// Seconds.
  std::optional<double> uptime_total_s;
  std::optional<double> drive_time_total_s;
  std::optional<double> auto_time_total_s;
  std::uint32_t mission_count_total = 0;
  std::uint32_t charge_cycles_total = 0;
  std::uint32_t reboot_count = 0;
  std::int64_t last_reboot_unix_time_ms = 0;

  friend bool operator==(const UsageTelemetry&, const UsageTelemetry&) = default;
};

/// What is left of a consumable; (kind, tank_id) is its key. Live. A value.
struct ConsumableStatus {
  std::int64_t unix_time_ms = 0;
  std::string kind;
  std::string tank_id;
  /// 0 to 100; absent only if judgement dropped it, as the two below.
  std::optional<float> level_pct;
  /// In unit.
  std::optional<float> amount_remaining;
  std::optional<std::string> unit;
  bool is_critical = false;

  friend bool operator==(const ConsumableStatus&, const ConsumableStatus&) = default;
};

/// `kind/tankId`.
[[nodiscard]] inline std::string KeyOf(const ConsumableStatus& status) {
  return status.kind + "/" + status.tank_id;
}

/// Whether the robot applies a rule of an area; directive_id is its key. Live. A value.
struct SpatialDirectiveStatus {
  std::string directive_id;
  std::int64_t last_eval_time_ms = 0;
  bool active = false;
  bool inside_zone = false;
  /// Metres.
  std::optional<float> distance_to_zone_m;

  friend bool operator==(const SpatialDirectiveStatus&, const SpatialDirectiveStatus&) = default;
};

[[nodiscard]] inline std::string KeyOf(const SpatialDirectiveStatus& status) {
  return status.directive_id;
}

/// What the agent is and runs on. Durable. A value.
struct AgentInfo {
  std::string agent_version;
  std::optional<std::string> software_version;
  std::optional<std::string> os_info;
  /// Seconds since boot.
  std::optional<std::uint64_t> uptime_s;

  friend bool operator==(const AgentInfo&, const AgentInfo&) = default;
};

}  // namespace uplink::model
