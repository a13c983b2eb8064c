#include "server/app_samples.h"

namespace uplink {

void AddRelaySamples(const relay::RelayProbe& probe, const session::SessionProbe& sessions,
                     const metrics::Cell& handshakes_failed, metrics::Exposition& page) {
  using enum metrics::MetricId;
  const auto value = [](const metrics::Cell& cell) { return static_cast<double>(cell.value()); };
  page.Add(kStreamsRefused, value(probe.refused_full_total) + value(sessions.refused_full_total),
           {"full"});
  page.Add(kStreamsRefused, value(probe.refused_draining_total), {"draining"});
  page.Add(kStreamsRefused,
           value(probe.refused_identity_total) + value(sessions.refused_identity_total),
           {"identity"});
  page.Add(kHandshakesFailed, handshakes_failed);
  page.Add(kFinishTimeouts, probe.finish_timeouts_total);
  page.Add(kWakes, probe.wakes_total);
}

}  // namespace uplink
