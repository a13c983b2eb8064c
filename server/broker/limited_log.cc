#include "server/broker/limited_log.h"

namespace uplink::broker {

void LimitedLog::Tell(TwinStream& stream, std::string_view why, SteadyTime now) {
  if (stream.limited_told_at && now - *stream.limited_told_at < log::RateLimited::kSpan) return;
  if (lines_.Write(log::Level::kWarn, "twin_limited", {{"robot", stream.ruri()}, {"why", why}})) {
    stream.limited_told_at = now;
  }
}

}  // namespace uplink::broker
