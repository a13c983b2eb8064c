#pragma once

#include <set>
#include <string>

#include "tools/uplink-fleet/twin/speech.h"

namespace uplink::synthetic {

/// What a twin's computers and devices report, of which the latest is shown; the errors among its
/// metrics, which are faults; and what is only observed. Thread: confined to one thread.
class Reports final {
 public:
  explicit Reports(const Speech& speech) : speech_(speech) {}

  /// Metrics without errors: they clear all that were named before.
  [[nodiscard]] Publication Metrics();
  /// With errors: some go on, one is new.
  [[nodiscard]] Publication MetricsWithErrors();
  /// By the driver, whose edge is the twin itself.
  [[nodiscard]] Publication DriverHealth();
  /// By the computer that it runs on.
  [[nodiscard]] Publication ComputerHealth();
  [[nodiscard]] Publication MotorStatus();
  [[nodiscard]] Publication DriverInfo();
  /// A report by its `telemetry_type`.
  [[nodiscard]] Publication BatteryReport();
  [[nodiscard]] Publication RobotState();
  [[nodiscard]] Publication BatteryStatus();
  [[nodiscard]] Publication Command();
  /// Carries a secret, which must show nowhere.
  [[nodiscard]] Publication Signalling();

 private:
  [[nodiscard]] Draft BeginMetrics(boost::json::object& metrics);
  void ChangeFaults(const Draft& draft, std::set<std::string> named);
  void Say(const Draft& draft, const std::string& path, boost::json::object fields,
           std::string_view source);

  Speech speech_;
  /// The errors that the last metrics named.
  std::set<std::string> errors_;
};

/// Stands in each text that must show nowhere.
inline constexpr std::string_view kSecret = "candidate:secret";

}  // namespace uplink::synthetic
