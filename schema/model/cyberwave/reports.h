#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// What happened, and what drivers report in their own words. `detail` is always the JSON text of
/// an object: numbers finite, texts without NUL, U+FFFD for control characters.
namespace uplink::model::cyberwave {

enum class MarkKind : std::uint8_t {
  kConnected,
  kTelemetryStart,
  kTelemetryEnd,
  kDisconnected,
  kInitialObservation,
};

/// The vendor's word.
[[nodiscard]] std::string_view ToText(MarkKind kind);
/// The mark of that word, or nothing.
[[nodiscard]] std::optional<MarkKind> MarkKindFromText(std::string_view text);

/// A client that came to a twin or left it: any client, a viewer's too. Durable. A value.
struct Mark {
  MarkKind kind = MarkKind::kConnected;
  /// The one stream that ended; empty if it is all.
  std::string sensor;
  /// A cut of a recording: nothing started or ended.
  bool recording_boundary = false;
  std::string detail;

  friend bool operator==(const Mark&, const Mark&) = default;
};

/// Something that happened to a twin. Durable. A value.
struct Event {
  /// Never empty.
  std::string type;
  /// Who found it; empty if that is not said.
  std::string source;
  std::string detail;

  friend bool operator==(const Event&, const Event&) = default;
};

enum class LogLevel : std::uint8_t { kUnknown, kDebug, kInfo, kWarning, kError, kCritical };

/// One line of a driver's log. Durable. A value.
struct DriverLog {
  /// Never empty.
  std::string message;
  LogLevel level = LogLevel::kUnknown;
  /// The level as it was sent.
  std::string level_text;
  std::string container_name;
  std::string source;
  /// The other members too, all but the message.
  std::string detail;

  friend bool operator==(const DriverLog&, const DriverLog&) = default;
};

enum class ReportKind : std::uint8_t {
  kMotorStatus,
  kDriverInfo,
  /// What `telemetry_type` names: battery, errors.
  kTelemetry,
  /// The state that nodes of mobile robots send as an event each second.
  kRobotState,
};

/// What a driver says of itself in its own form; the latest counts. Live. A value.
struct Report {
  ReportKind kind = ReportKind::kTelemetry;
  /// Never empty.
  std::string name;
  /// Of a telemetry `battery`: 0 to 100.
  std::optional<double> battery_percent;
  std::optional<bool> battery_charging;
  std::string detail;

  friend bool operator==(const Report&, const Report&) = default;
};

}  // namespace uplink::model::cyberwave
