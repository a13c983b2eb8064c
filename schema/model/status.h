#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/enum_text.h"

namespace uplink::model {

enum class RobotMode : std::uint16_t { kManual = 0, kAuto = 1, kTeleop = 2, kIdle = 3 };
template <>
inline constexpr auto kEnumNames<RobotMode> = std::to_array<std::string_view>({"manual", "auto",
                                                                               "teleop", "idle"});

enum class PowerSupplyStatus : std::uint16_t {
  kUnknown = 0,
  kCharging = 1,
  kDischarging = 2,
  kNotCharging = 3,
  kFull = 4,
};
template <>
inline constexpr auto kEnumNames<PowerSupplyStatus> =
    std::to_array<std::string_view>({"unknown", "charging", "discharging", "notCharging", "full"});

enum class PowerSupplyHealth : std::uint16_t {
  kUnknown = 0,
  kGood = 1,
  kOverheat = 2,
  kDead = 3,
  kOvervoltage = 4,
  kUnspecifiedFailure = 5,
  kCold = 6,
  kWatchdogTimerExpire = 7,
  kSafetyTimerExpire = 8,
};
template <>
inline constexpr auto kEnumNames<PowerSupplyHealth> = std::to_array<std::string_view>(
    {"unknown", "good", "overheat", "dead", "overvoltage", "unspecifiedFailure", "cold",
     "watchdogTimerExpire", "safetyTimerExpire"});

enum class PowerSupplyTechnology : std::uint16_t {
  kUnknown = 0,
  kNiMh = 1,
  kLiIon = 2,
  kLiPo = 3,
  kLiFe = 4,
  kNiCd = 5,
  kLiMn = 6,
};
template <>
inline constexpr auto kEnumNames<PowerSupplyTechnology> =
    std::to_array<std::string_view>({"unknown", "niMH", "liIon", "liPo", "liFe", "niCd", "liMn"});

/// Battery; absent fields were not sent, or were dropped. A value.
struct BatteryStatus {
  /// State of charge, 0 to 100.
  std::optional<float> soc_pct;
  std::optional<float> voltage_v;
  std::optional<float> current_a;
  std::optional<float> charge_ah;
  std::optional<float> capacity_ah;
  std::optional<float> design_capacity_ah;
  /// Degrees Celsius.
  std::optional<float> temperature;
  PowerSupplyStatus power_supply_status = PowerSupplyStatus::kUnknown;
  PowerSupplyHealth power_supply_health = PowerSupplyHealth::kUnknown;
  PowerSupplyTechnology power_supply_technology = PowerSupplyTechnology::kUnknown;

  friend bool operator==(const BatteryStatus&, const BatteryStatus&) = default;
};

/// Fuel; absent fields were not sent, or were dropped. A value.
struct FuelStatus {
  /// 0 to 100.
  std::optional<float> level_pct;
  /// In volume_unit.
  std::optional<float> volume_remaining;
  /// Of the tank, in volume_unit.
  std::optional<float> capacity;
  std::optional<std::string> volume_unit;
  /// In efficiency_unit.
  std::optional<float> efficiency;
  std::optional<std::string> efficiency_unit;
  bool is_refueling = false;

  friend bool operator==(const FuelStatus&, const FuelStatus&) = default;
};

/// The physical emergency stop as the robot reports it. A value.
struct EStop {
  std::int64_t unix_time_ms = 0;
  bool active = false;
  /// The stops that are engaged.
  std::vector<std::string> ids;

  friend bool operator==(const EStop&, const EStop&) = default;
};

/// General state. Live. A value.
struct StatusTelemetry {
  std::int64_t unix_time_ms = 0;
  std::optional<BatteryStatus> battery;
  std::optional<RobotMode> mode;
  /// Absent if the message holds none (a null pointer): that is not "released".
  std::optional<EStop> estop;
  bool faulted = false;
  /// The robot can accept missions.
  bool mission_active = false;
  /// The maker's own text; absent only if judgement dropped it.
  std::optional<std::string> status;
  std::optional<FuelStatus> fuel;
  /// Metres.
  std::optional<double> range_remaining;
  /// Seconds.
  std::optional<double> runtime_remaining;

  friend bool operator==(const StatusTelemetry&, const StatusTelemetry&) = default;
};

}  // namespace uplink::model
