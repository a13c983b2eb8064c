#include "server/session/samples.h"

#include <algorithm>
#include <cstddef>

namespace uplink::session {

void AddSamples(const SessionProbe& probe, metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kStreams, probe.streams);
  page.Add(kStreamsOpened, probe.streams_total);
  page.Add(kHoldBacks, probe.held_back_total);
  auto ending = static_cast<double>(probe.held_back.value());
  for (std::size_t by = 1; by < robot::kHeldBackReasons; ++by) {
    const std::string_view reason = ToText(static_cast<robot::HeldBack>(by));
    const auto held = static_cast<double>(probe.held_back_by[by].value());
    page.Add(kStreamsHeldBack, held, {reason});
    ending -= held;
    page.Add(kHeldBackByTotal, probe.held_back_by_total[by], {reason});
  }
  // These have no reason. The cells are read one after another, while streams change.
  page.Add(kStreamsHeldBack, std::max(ending, 0.0), {"ending"});
  page.Add(kStreamsWaiting, probe.waiting);
  page.Add(kStreamDelays, probe.delayed_total);
  page.Add(kTakeovers, probe.takeovers_total);
  page.Add(kContested, probe.contested_total);
  page.Add(kSuperseded, probe.superseded_total);
  for (std::size_t end = 0; end < kStreamEnds.size(); ++end) {
    page.Add(kStreamsEnded, probe.ended_total[end], {kStreamEnds[end]});
  }
  page.Add(kProtocolErrors, probe.protocol_errors_total);
  page.Add(kPeerStalls, probe.peer_stalls_total);
  page.Add(kRejectsUnconfirmed, probe.unconfirmed_total);
  page.Add(kRejectPages, probe.reject_pages_total);
  page.Add(kRejectReadsFailed, probe.reject_reads_failed_total);
  page.Add(kResumes, probe.resumes_total);
  for (const storage::LatestKind kind : storage::kEachLatestKind) {
    const auto place = static_cast<std::size_t>(kind);
    const std::string_view name = model::ToText(storage::VariantOf(kind));
    page.Add(kResendRequests, probe.resend_requests_total[place], {name});
    page.Add(kResendUnanswered, probe.resend_unanswered[place], {name});
  }
  page.Add(kFrames, probe.frames_total);
  page.Add(kFrameBytes, probe.frame_bytes_total);
  page.Add(kAcks, probe.acks_total);
  for (std::size_t i = 0; i < metrics::kTelemetryKinds.size(); ++i) {
    page.Add(kTelemetryOverRate, probe.over_rate_total[i].value(),
             {metrics::KindText(metrics::kTelemetryKinds[i])});
  }
  page.Add(kNotices, probe.notices_total);
  page.Add(kAckSeconds, probe.ack_seconds);
}

void AddSamples(const transport::RelayProbe& probe, const transport::RelayProbe& operators,
                const SessionProbe& sessions, metrics::Exposition& page) {
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
  page.Add(kStreamsRefused, sessions.refused_operator_total, {"operator"});
  page.Add(kGatewayStreams, probe.gateway_streams);
  page.Add(kHandshakesFailed, probe.handshakes_failed_total);
  for (std::size_t cause = 0; cause < transport::kTurnedAwayTexts.size(); ++cause) {
    page.Add(kConnectionsTurnedAway, probe.turned_away_total[cause],
             {transport::kTurnedAwayTexts[cause]});
  }
  for (std::size_t why = 0; why < transport::kDeniedTexts.size(); ++why) {
    page.Add(kCertificatesDenied,
             probe.denied_total[why].value() + operators.denied_total[why].value(),
             {transport::kDeniedTexts[why]});
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

}  // namespace uplink::session
