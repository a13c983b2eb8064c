#include "server/http/entrance.h"

#include <string>

#include "server/http/errors.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

Response AnswerOfStart(const Request& request, RouteId route) {
  if (route.index >= Routes().size()) return Starting();
  if (request.method == Method::kOther) return MethodNotAllowed();
  const Target target = SplitTarget(request.target);
  const std::string query(target.query);
  if (target.path == "/livez") return StartingLivez(query);
  if (target.path == "/readyz") return StartingReadyz(query);
  return Starting();
}

}  // namespace

Resolved Entrance::Resolve(const Request& request) const {
  const RouteId route = FindRoute(SplitTarget(request.target).path).id;
  if (request.host_required && !request.host) {
    return AtOnce(route, BadRequest(400, "an HTTP/1.1 request has one Host header"));
  }
  if (!IsMonitoring(route)) {
    if (request.host && !hosts_.Has(*request.host)) return AtOnce(route, MisdirectedRequest());
    if (request.monitoring_only) return AtOnce(route, TooManyConnections());
  }
  const Site* site = site_.load();
  if (site == nullptr) return AtOnce(route, AnswerOfStart(request, route));
  return site->Resolve(request);
}

}  // namespace uplink::http
