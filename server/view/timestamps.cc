#include "server/view/timestamps.h"

#include <algorithm>
#include <chrono>

namespace uplink::view {

google::protobuf::Timestamp ToTimestamp(SystemTime time) {
  const SystemTime shown = std::clamp(time, kRfc3339First, kRfc3339Last);
  const auto second = std::chrono::floor<std::chrono::seconds>(shown);
  google::protobuf::Timestamp timestamp;
  timestamp.set_seconds(second.time_since_epoch().count());
  timestamp.set_nanos(static_cast<std::int32_t>(std::chrono::nanoseconds(shown - second).count()));
  return timestamp;
}

std::int64_t UnixMs(const google::protobuf::Timestamp& time) {
  constexpr std::int64_t kMsPerSecond = 1'000;
  constexpr std::int64_t kNanosPerMs = 1'000'000;
  return time.seconds() * kMsPerSecond + time.nanos() / kNanosPerMs;
}

}  // namespace uplink::view
