#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/enum_text.h"
#include "schema/model/operator_request.h"

/// What a drone reports to people: durable. An empty text was not said.
namespace uplink::model::uncrew {

enum class StatusTextLevel : std::int32_t { kNotice = 2, kWarning = 3 };

/// A value.
struct StatusText {
  StatusTextLevel type{};
  /// Never empty.
  std::string text;

  friend bool operator==(const StatusText&, const StatusText&) = default;
};

/// Something went wrong aboard. A value.
struct Error {
  std::string code;
  /// Never empty.
  std::string text;
  std::string source;
  std::string command_id;

  friend bool operator==(const Error&, const Error&) = default;
};

enum class ConnectionEventKind : std::int32_t {};

/// A link aboard, or of the drone, came or went. A value.
struct ConnectionEvent {
  ConnectionEventKind kind{};
  std::string link;
  /// Never empty.
  std::string text;

  friend bool operator==(const ConnectionEvent&, const ConnectionEvent&) = default;
};

enum class ProcedureState : std::int32_t {};

/// What became of a command that somebody else gave. A value.
struct CommandResult {
  /// Never empty.
  std::string command_id;
  ProcedureState state{};
  std::string code;
  std::string text;

  friend bool operator==(const CommandResult&, const CommandResult&) = default;
};

enum class AlertKind : std::int32_t { kBattery, kBatteryPercentage, kFlightTermination };

/// What the drone does about an alert by itself.
enum class AlertReaction : std::int32_t { kNone, kReturnToLaunch };

/// What is wrong now. A value.
struct Alert {
  /// Unique in its set; the drone's own, or its kind and battery: `battery_percentage/0`.
  std::string alert_id;
  AlertKind kind = AlertKind::kBattery;
  /// The drone's clock; 0: unknown.
  std::int64_t raised_at_us = 0;
  std::string text;
  std::optional<AlertReaction> reaction;
  // Of the kinds that have them.
  std::optional<std::uint32_t> battery_id;
  std::string condition;
  std::optional<float> remaining_percent;
  std::optional<float> threshold_percent;
  std::string cause;

  friend bool operator==(const Alert&, const Alert&) = default;
};

/// All that are active. A value.
struct Alerts {
  std::vector<Alert> items;

  friend bool operator==(const Alerts&, const Alerts&) = default;
};

/// What a drone waits for an operator to do. A value.
struct OperatorActionRequest {
  /// Unique in its set, never empty.
  std::string request_id;
  OperatorRequestKind kind = OperatorRequestKind::kConfirmDeliveryReady;
  /// The drone's clock; 0: unknown.
  std::int64_t requested_at_us = 0;
  std::string text;

  friend bool operator==(const OperatorActionRequest&, const OperatorActionRequest&) = default;
};

/// All that wait. A value.
struct OperatorRequests {
  std::vector<OperatorActionRequest> items;

  friend bool operator==(const OperatorRequests&, const OperatorRequests&) = default;
};

}  // namespace uplink::model::uncrew

namespace uplink::model {

template <>
inline constexpr auto kEnumNames<uncrew::StatusTextLevel> = std::to_array<std::string_view>(
    {"debug", "info", "notice", "warning", "error", "critical", "alert", "emergency"});
template <>
inline constexpr auto kEnumNames<uncrew::ConnectionEventKind> =
    std::to_array<std::string_view>({"unknown", "connected", "disconnected"});
template <>
inline constexpr auto kEnumNames<uncrew::AlertKind> =
    std::to_array<std::string_view>({"battery", "battery_percentage", "flight_termination"});
template <>
inline constexpr auto kEnumNames<uncrew::AlertReaction> =
    std::to_array<std::string_view>({"none", "return_to_launch"});
template <>
inline constexpr auto kEnumNames<uncrew::ProcedureState> = std::to_array<std::string_view>(
    {"unspecified", "started", "succeeded", "failed", "refused", "expired", "cancelled"});

}  // namespace uplink::model
