#pragma once

#include <cstdint>

#include "schema/base/clock.h"
#include "schema/model/cyberwave/head.h"
#include "server/cyberwave/session_times.h"

namespace uplink::cyberwave {

/// When a message arrived, by both clocks of the server. A value.
struct Arrival {
  SteadyTime steady;
  SystemTime system;
};

/// When a value was said, and when that arrived. A value.
struct Stamp {
  /// Microseconds since the Unix epoch, by the publisher's clock; 0: unknown.
  std::int64_t timestamp_us = 0;
  Arrival arrived;
};

/// The latest of a value, its source, and when it was said. A value.
template <typename T>
struct Held {
  T value;
  model::cyberwave::Source source;
  Stamp stamp;
  SessionTimes times;
};

}  // namespace uplink::cyberwave
