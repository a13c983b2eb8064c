#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace uplink::model::cyberwave {

/// A scalar of a free-form metric.
using MetricValue = std::variant<double, bool, std::string>;

/// One value of a metrics message. A value.
struct Metric {
  /// The member of `metrics` that it stands in: `power`.
  std::string category;
  /// Its name there, those of nested objects and the numbers of list items joined by `/`; empty if
  /// the category is itself the value.
  std::string name;
  MetricValue value;

  friend bool operator==(const Metric&, const Metric&) = default;
};

/// A snapshot of metrics, which has no time of its own. A value.
struct Metrics {
  std::vector<Metric> metrics;
  /// What is wrong, in words; the durable part. Nothing: the message does not speak of errors.
  std::optional<std::vector<std::string>> errors;

  friend bool operator==(const Metrics&, const Metrics&) = default;
};

/// One camera or microphone of an edge device. A value.
struct EdgeStream {
  /// Unique in its message, never empty.
  std::string id;
  std::string camera_id;
  std::string connection_state;
  std::string ice_connection_state;
  std::optional<std::uint64_t> frames_sent;
  /// Microseconds since the Unix epoch; 0: not known.
  std::int64_t last_frame_us = 0;
  std::optional<double> fps;
  std::optional<double> uptime_s;
  std::optional<std::uint64_t> restart_count;
  std::optional<bool> is_stale;
  std::optional<bool> is_healthy;

  friend bool operator==(const EdgeStream&, const EdgeStream&) = default;
};

/// How an edge device, or a driver on it, does. A value.
struct EdgeHealth {
  /// Never empty: the twin's id if the message gives none.
  std::string edge_id;
  std::optional<double> uptime_s;
  std::vector<EdgeStream> streams;
  std::optional<std::uint64_t> stream_count;
  std::optional<std::uint64_t> healthy_streams;
  /// Of the device's computer; 0 to 100.
  std::optional<double> host_memory_percent;
  std::optional<double> host_cpu_percent;
  std::optional<double> host_disk_percent;
  std::optional<double> cpu_temp_c;

  friend bool operator==(const EdgeHealth&, const EdgeHealth&) = default;
};

/// What a driver says of a battery. A value.
struct BatteryStatus {
  /// 0 to 100; older drivers mean 0 to 1, so that up to 1 it is ambiguous.
  std::optional<double> percentage;
  std::optional<double> voltage_v;
  std::optional<bool> charging;

  friend bool operator==(const BatteryStatus&, const BatteryStatus&) = default;
};

}  // namespace uplink::model::cyberwave
