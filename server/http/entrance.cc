#include "server/http/entrance.h"

#include <string_view>

#include "server/http/errors.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

Response AnswerOfStart(const Request& request, std::string_view path) {
  if (request.method == Method::kOther) return Starting();
  if (path == "/livez") return StartingLivez();
  if (path == "/readyz") return StartingReadyz();
  return Starting();
}

}  // namespace

Resolved Entrance::Resolve(const Request& request) const {
  const std::string_view path = SplitTarget(request.target).path;
  const RouteId route = FindRoute(path).id;
  if (request.host_required && !request.host) {
    return AtOnce(route, BadRequest(400, "an HTTP/1.1 request has one Host header"));
  }
  if (!IsMonitoring(route)) {
    if (request.host && !hosts_.Has(*request.host)) return AtOnce(route, MisdirectedRequest());
    if (request.monitoring_only) return AtOnce(route, TooManyConnections());
  }
  const Site* site = site_.load();
  if (site == nullptr) return AtOnce(route, AnswerOfStart(request, path));
  return site->Resolve(request);
}

}  // namespace uplink::http
