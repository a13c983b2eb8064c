#include "server/http/samples.h"

#include <string_view>

#include "server/http/routes.h"
#include "server/loop/read_threads.h"

namespace uplink::http {

namespace {

/// `http` of listen.http.
std::string_view LabelOf(std::string_view key) { return key.substr(key.find('.') + 1); }

}  // namespace

void AddSamples(const HttpProbe& probe, const ConnectionsMax& connections_max,
                metrics::Exposition& page) {
  using enum metrics::MetricId;
  for (std::size_t route = 0; route < probe.requests.size(); ++route) {
    for (std::size_t code = 0; code < kCodeClasses.size(); ++code) {
      page.Add(kHttpRequests, probe.requests[route][code],
               {RouteName(RouteId{route}), kCodeClasses[code]});
    }
  }
  page.Add(kHttpRequestSeconds, probe.request_seconds);
  for (std::size_t listener = 0; listener < kListenerKeys.size(); ++listener) {
    const std::string_view label = LabelOf(kListenerKeys[listener]);
    const ConnectionProbe& connections = probe.connections[listener];
    page.Add(kHttpConnections, connections.open, {label});
    page.Add(kHttpConnectionsLimit, connections_max[listener], {label});
    page.Add(kHttpConnectionsRefused, connections.refused, {label});
    page.Add(kHttpConnectionsGivenUp, connections.given_up, {label});
  }
  page.Add(kHttpReadsWaiting, probe.reads_waiting);
  page.Add(kHttpReadsWaitingLimit, loop::kReadsWaitingMax);
  page.Add(kHttpReadsRefused, probe.reads_refused);
  for (std::size_t why = 0; why < kDeniedTexts.size(); ++why) {
    page.Add(kHttpDenied, probe.denied[why], {kDeniedTexts[why]});
  }
  page.Add(kHttpTokens, probe.tokens);
}

}  // namespace uplink::http
