#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/model/value.h"

namespace uplink::model {

/// One reading of the maker's own. A value.
struct SensorReading {
  std::string key;
  Value value;
  std::optional<std::int64_t> unix_time_ms;

  friend bool operator==(const SensorReading&, const SensorReading&) = default;
};

/// Readings beyond motion and status; keys are unique. Live. A value.
struct TelemetryExtras {
  std::int64_t unix_time_ms = 0;
  std::vector<SensorReading> kv;

  friend bool operator==(const TelemetryExtras&, const TelemetryExtras&) = default;
};

}  // namespace uplink::model
