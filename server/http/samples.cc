#include "server/http/samples.h"

#include "server/http/routes.h"
#include "server/loop/read_thread.h"

namespace uplink::http {

void AddSamples(const HttpProbe& probe, std::size_t connections_max, metrics::Exposition& page) {
  using enum metrics::MetricId;
  for (std::size_t route = 0; route < probe.requests.size(); ++route) {
    for (std::size_t code = 0; code < kCodeClasses.size(); ++code) {
      page.Add(kHttpRequests, probe.requests[route][code],
               {RouteName(RouteId{route}), kCodeClasses[code]});
    }
  }
  page.Add(kHttpRequestSeconds, probe.request_seconds);
  page.Add(kHttpConnections, probe.connections);
  page.Add(kHttpConnectionsLimit, connections_max);
  page.Add(kHttpConnectionsRefused, probe.connections_refused);
  page.Add(kHttpConnectionsGivenUp, probe.connections_given_up);
  page.Add(kHttpReadsWaiting, probe.reads_waiting);
  page.Add(kHttpReadsWaitingLimit, loop::kReadsWaitingMax);
  page.Add(kHttpReadsRefused, probe.reads_refused);
}

}  // namespace uplink::http
