#include "server/broker/limited_log.h"

#include <string>

#include <fmt/core.h>

#include "server/broker/limits.h"

namespace uplink::broker {

void LimitedLog::Tell(TwinStream& stream, std::string_view why, SteadyTime now) {
  if (stream.limited_told_at && now - *stream.limited_told_at < log::RateLimited::kSpan) return;
  if (lines_.Write(log::Level::kWarn, "twin_limited", {{"robot", stream.ruri()}, {"why", why}})) {
    stream.limited_told_at = now;
  }
}

void LimitedLog::Tell(const cyberwave::Topic& topic) {
  const std::string name =
      topic.kind == cyberwave::TopicKind::kPing ? topic.name : topic.id.ToText();
  lines_.Write(log::Level::kWarn, "twin_limited",
               {{"id", name},
                {"why", fmt::format("more than {} bytes per second at QoS 0, after {} at once",
                                    kBytesOfId.rate, kBytesOfId.burst)}});
}

}  // namespace uplink::broker
