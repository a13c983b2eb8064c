#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/enum_text.h"
#include "schema/model/value.h"

namespace uplink::model {

enum class CapabilityType : std::uint16_t { kTrigger = 0, kSetBool = 1, kMissionType = 2 };
template <>
inline constexpr auto kEnumNames<CapabilityType> =
    std::to_array<std::string_view>({"trigger", "setBool", "missionType"});

enum class Role : std::uint16_t { kViewer = 0, kOperator = 1, kAdmin = 2, kOwner = 3 };
template <>
inline constexpr auto kEnumNames<Role> = std::to_array<std::string_view>({"viewer", "operator",
                                                                          "admin", "owner"});

enum class DangerLevel : std::uint16_t { kNormal = 0, kWarning = 1, kCritical = 2 };
template <>
inline constexpr auto kEnumNames<DangerLevel> =
    std::to_array<std::string_view>({"normal", "warning", "critical"});

enum class DisplayHint : std::uint16_t {
  kNone = 0,
  kOnOff = 1,
  kGauge = 2,
  kText = 3,
  kOnline = 4,
  kWarningLight = 5,
  kTemperature = 6,
  kProgress = 7,
};
template <>
inline constexpr auto kEnumNames<DisplayHint> = std::to_array<std::string_view>(
    {"none", "onOff", "gauge", "text", "online", "warningLight", "temperature", "progress"});

struct Range {
  double min = 0;
  double max = 0;

  friend bool operator==(const Range&, const Range&) = default;
};

struct ServiceCapability {
  std::string name;
  std::string description;
  CapabilityType capability_type = CapabilityType::kTrigger;
  std::optional<std::string> confirmation_message;
  std::string state_key;
  Role requires_role = Role::kViewer;
  DangerLevel danger_level = DangerLevel::kNormal;

  friend bool operator==(const ServiceCapability&, const ServiceCapability&) = default;
};

struct SensorCapability {
  std::string key;
  std::string label;
  ValueType value_type = ValueType::kString;
  std::string unit;
  /// rangeMin and rangeMax.
  std::optional<Range> range;
  DisplayHint display_hint = DisplayHint::kNone;

  friend bool operator==(const SensorCapability&, const SensorCapability&) = default;
};

struct SettingDescriptor {
  std::string key;
  std::string label;
  ValueType value_type = ValueType::kString;
  Value default_value;
  std::optional<Range> range;
  std::optional<double> step;

  friend bool operator==(const SettingDescriptor&, const SettingDescriptor&) = default;
};

/// What the robot can do and how to show it; names and keys are unique in their list. Durable. A
/// value.
struct UiCapabilities {
  std::vector<ServiceCapability> services;
  std::vector<SensorCapability> sensors;
  std::vector<SettingDescriptor> settings;

  friend bool operator==(const UiCapabilities&, const UiCapabilities&) = default;
};

struct SettingUpdate {
  std::string key;
  Value value;

  friend bool operator==(const SettingUpdate&, const SettingUpdate&) = default;
};

/// The settings that the robot runs; keys are unique. Durable. A value.
struct CurrentSettings {
  std::vector<SettingUpdate> settings;

  friend bool operator==(const CurrentSettings&, const CurrentSettings&) = default;
};

}  // namespace uplink::model
