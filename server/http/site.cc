#include "server/http/site.h"

#include <exception>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "metrics/gzip.h"
#include "server/http/errors.h"
#include "server/http/negotiate.h"
#include "server/http/target.h"
#include "server/view/json.h"

namespace uplink::http {
namespace {

Resolved AtOnce(RouteId route, Response response) {
  return {route, Lane::kIo, [answer = std::move(response)] { return answer; }};
}

/// Probes take no parameters.
std::optional<BadParameter> NoParameters(const std::string& query) {
  return Parameters(query).Problem();
}

/// The head of a scrape.
Response ScrapeResponse(metrics::Format format, metrics::Coding coding) {
  Response response;
  response.content_type = metrics::MediaType(format);
  if (coding == metrics::Coding::kGzip) response.coding = "gzip";
  response.varies = true;
  return response;
}

}  // namespace

Site::Site(view::Queries& queries, health::Monitor& monitor, const Scrape& scrape,
           rcan::RobotScrape& robots)
    : queries_(queries), monitor_(monitor), scrape_(scrape), robots_(robots) {}

constexpr std::array<Site::Route, 16> Site::kRoutes = {{
    {"/livez", RouteId::kLivez, Lane::kIo, &Site::Livez},
    {"/readyz", RouteId::kReadyz, Lane::kIo, &Site::Readyz},
    {"/metrics", RouteId::kMetrics, Lane::kIo, &Site::Metrics},
    {"/metrics/robots", RouteId::kMetricsRobots, Lane::kScrape, &Site::MetricsOfRobots},
    {"/api/v1/status", RouteId::kStatus, Lane::kRead, &Site::Status},
    {"/api/v1/robots", RouteId::kRobots, Lane::kRead, &Site::Robots},
    {"/api/v1/robots/{}", RouteId::kRobot, Lane::kRead, &Site::Robot},
    {"/api/v1/robots/{}/events", RouteId::kEvents, Lane::kRead, &Site::Events},
    {"/api/v1/robots/{}/messages", RouteId::kMessages, Lane::kRead, &Site::Messages},
    {"/api/v1/robots/{}/presence", RouteId::kPresence, Lane::kRead, &Site::Presence},
    {"/api/v1/robots/{}/quarantine", RouteId::kQuarantine, Lane::kRead, &Site::Quarantine},
    {"/api/v1/robots/{}/gaps", RouteId::kGaps, Lane::kRead, &Site::Gaps},
    {"/api/v1/faults", RouteId::kFaults, Lane::kRead, &Site::Faults},
    {"/api/v1/missions", RouteId::kMissions, Lane::kRead, &Site::Missions},
    {"/api/v1/shapes", RouteId::kShapes, Lane::kRead, &Site::Shapes},
    {"/api/v1/objects", RouteId::kObjects, Lane::kRead, &Site::Objects},
}};

Resolved Site::Resolve(const Request& request) const {
  const TargetParts target = SplitTarget(request.target);
  for (const Route& route : kRoutes) {
    std::optional<PathMatch> match = MatchPath(route.pattern, target.path);
    if (!match) continue;
    if (request.method == Method::kOther) return AtOnce(route.id, MethodNotAllowed());
    Call call{std::move(match->segment), std::string(target.query), FormatFor(request.accept),
              CodingFor(request.accept_encoding)};
    return {route.id, route.lane, [this, handler = route.handler, call = std::move(call)] {
              // What a library throws under a handler (memory) ends here.
              try {
                return (this->*handler)(call);
              } catch (const std::exception& error) {
                return ErrorResponse(absl::InternalError(error.what()));
              }
            }};
  }
  return AtOnce(RouteId::kOther, NoSuchPath(target.path));
}

Response Site::Livez(const Call& call) const {
  if (const auto problem = NoParameters(call.query)) return ErrorResponse(*problem);
  const auto age = std::chrono::duration_cast<std::chrono::seconds>(monitor_.liveness().age());
  Response response;
  response.status = monitor_.liveness().alive() ? 200 : 503;
  response.body = fmt::format(R"({{"relayLastHandshakeSeconds":{}}})", age.count());
  return response;
}

Response Site::Readyz(const Call& call) const {
  if (const auto problem = NoParameters(call.query)) return ErrorResponse(*problem);
  const health::Readiness readiness = monitor_.readiness();
  Response response;
  response.status = readiness.ready() ? 200 : 503;
  response.body = readiness.ready() ? view::WordsJson("degraded", readiness.degraded)
                                    : view::WordsJson("refuses", readiness.refuses);
  return response;
}

Response Site::Metrics(const Call& call) const {
  if (const auto problem = NoParameters(call.query)) return ErrorResponse(*problem);
  Response response = ScrapeResponse(call.format, call.coding);
  std::string text = scrape_.Text(call.format);
  if (call.coding == metrics::Coding::kGzip) {
    metrics::Gzip(text, response.body);
  } else {
    response.body = std::move(text);
  }
  return response;
}

Response Site::MetricsOfRobots(const Call& call) const {
  if (const auto problem = NoParameters(call.query)) return ErrorResponse(*problem);
  Response response = ScrapeResponse(call.format, call.coding);
  response.shared_body = robots_.Text(call.format, call.coding);
  if (response.shared_body == nullptr) return TooBusy();
  return response;
}

}  // namespace uplink::http
