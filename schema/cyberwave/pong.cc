#include "schema/cyberwave/pong.h"

#include <cstdint>

#include <fmt/format.h>

namespace uplink::cyberwave {
namespace {

constexpr std::int64_t kMsPerSecond = 1000;

}  // namespace

std::string PongTopic(const Topic& ping) {
  return fmt::format("{}{}pong/{}/response", ping.prefix, kRoot, ping.name);
}

std::string PongPayload(SystemTime now) {
  const std::int64_t ms = UnixMs(now);
  return fmt::format(R"({{"type":"pong","timestamp":{}.{:03}}})", ms / kMsPerSecond,
                     ms % kMsPerSecond);
}

}  // namespace uplink::cyberwave
