#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "schema/model/enum_text.h"
#include "schema/model/status.h"

namespace uplink::model {

enum class FaultSeverity : std::uint16_t { kInfo = 0, kMinor = 1, kMajor = 2, kCritical = 3 };
template <>
inline constexpr auto kEnumNames<FaultSeverity> =
    std::to_array<std::string_view>({"info", "minor", "major", "critical"});

/// A fault raised or cleared; (robot, fault_id, source) is its key. Durable. A value.
struct Fault {
  std::int64_t unix_time_ms = 0;
  std::string fault_id;
  std::string source;
  FaultSeverity severity = FaultSeverity::kInfo;
  /// True on raise, false on clear.
  bool active = false;
  std::string category;
  std::string description;
  std::string suggested_action;

  friend bool operator==(const Fault&, const Fault&) = default;
};

struct EstopEngagedEvent {
  friend bool operator==(const EstopEngagedEvent&, const EstopEngagedEvent&) = default;
};

struct EstopReleasedEvent {
  friend bool operator==(const EstopReleasedEvent&, const EstopReleasedEvent&) = default;
};

struct ModeChangedEvent {
  RobotMode from = RobotMode::kManual;
  RobotMode to = RobotMode::kManual;

  friend bool operator==(const ModeChangedEvent&, const ModeChangedEvent&) = default;
};

struct MissionStartedEvent {
  std::string mission_id;

  friend bool operator==(const MissionStartedEvent&, const MissionStartedEvent&) = default;
};

struct MissionCompletedEvent {
  std::string mission_id;

  friend bool operator==(const MissionCompletedEvent&, const MissionCompletedEvent&) = default;
};

struct FaultRaisedEvent {
  std::string fault_code;
  std::string description;

  friend bool operator==(const FaultRaisedEvent&, const FaultRaisedEvent&) = default;
};

struct FaultClearedEvent {
  std::string fault_code;

  friend bool operator==(const FaultClearedEvent&, const FaultClearedEvent&) = default;
};

/// An event in its sender's own words, from a fleet that does not speak the Rover Nexus wire, which
/// has no member for it.
struct NamedEvent {
  /// `cyberwave/connected`; never empty.
  std::string kind;
  /// The JSON text of an object, kept as it stands.
  std::string detail_json;

  friend bool operator==(const NamedEvent&, const NamedEvent&) = default;
};

/// A transition; the alternatives stand in the order of the wire's union, and behind them what the
/// wire does not have.
using EventKind =
    std::variant<EstopEngagedEvent, EstopReleasedEvent, ModeChangedEvent, MissionStartedEvent,
                 MissionCompletedEvent, FaultRaisedEvent, FaultClearedEvent, NamedEvent>;

/// The union member's name: `modeChanged`; of a named event its kind, which lives as long as it.
[[nodiscard]] std::string_view EventKindText(const EventKind& kind);

/// A discrete transition. Durable. A value.
struct EventTelemetry {
  std::int64_t unix_time_ms = 0;
  EventKind kind;

  friend bool operator==(const EventTelemetry&, const EventTelemetry&) = default;
};

enum class MessageLevel : std::uint16_t { kInfo = 0, kWarn = 1, kError = 2 };
template <>
inline constexpr auto kEnumNames<MessageLevel> = std::to_array<std::string_view>({"info", "warn",
                                                                                  "error"});

/// Text for people. Durable. A value.
struct Message {
  std::int64_t unix_time_ms = 0;
  MessageLevel level = MessageLevel::kInfo;
  std::string message;
  /// What else its sender said, as the JSON text of an object; empty if that is nothing. Payloads
  /// of generation 0.1 have none.
  std::string detail_json{};
  /// The level as its sender calls it, finer than `level`: `notice`; empty if it says none.
  std::string source_level{};

  friend bool operator==(const Message&, const Message&) = default;
};

}  // namespace uplink::model
