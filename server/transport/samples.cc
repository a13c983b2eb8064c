#include "server/transport/samples.h"

namespace uplink::transport {

void AddSamples(const RelayProbe& probe, const session::SessionProbe& sessions,
                metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kStreamsRefused, probe.refused_full_total.value() + sessions.refused_full_total.value(),
           {"full"});
  page.Add(kStreamsRefused, probe.refused_draining_total, {"draining"});
  page.Add(kStreamsRefused,
           probe.refused_identity_total.value() + sessions.refused_identity_total.value(),
           {"identity"});
  page.Add(kStreamsRefused,
           sessions.refused_waiting_total.value() + probe.refused_robot_total.value(), {"waiting"});
  page.Add(kStreamsRefused, probe.refused_request_total, {"request"});
  page.Add(kStreamsRefused,
           probe.refused_gateway_total.value() + sessions.refused_gateway_total.value(),
           {"gateway"});
  page.Add(kGatewayStreams, probe.gateway_streams);
  page.Add(kHandshakesFailed, probe.handshakes_failed_total);
  for (std::size_t cause = 0; cause < kTurnedAwayTexts.size(); ++cause) {
    page.Add(kConnectionsTurnedAway, probe.turned_away_total[cause], {kTurnedAwayTexts[cause]});
  }
  page.Add(kConnections, probe.connections);
  page.Add(kConnectionsLimit, probe.connections_limit);
  page.Add(kHandshakesUnderWay, probe.handshakes_under_way);
  page.Add(kHandshakesWaiting, probe.handshakes_waiting);
  page.Add(kProxyHeadersWaiting, probe.proxy_headers_waiting);
  page.Add(kUnfinishedBytes, probe.unfinished_bytes);
  page.Add(kUnfinishedEnds, probe.unfinished_ends_total);
  page.Add(kAcceptPauses, probe.accept_pauses_total);
  page.Add(kFinishTimeouts, probe.finish_timeouts_total);
  page.Add(kWakes, probe.wakes_total);
}

}  // namespace uplink::transport
