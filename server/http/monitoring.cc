// The handlers of what supervisors and Prometheus ask: liveness, readiness, scrapes.
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "metrics/gzip.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/view/json.h"

namespace uplink::http {
namespace {

/// None of them takes parameters.
std::optional<BadParameter> NoParameters(const std::string& query) {
  return Parameters(query).Problem();
}

Response LivezResponse(int status, milliseconds age) {
  Response response;
  response.status = status;
  response.body = fmt::format(R"({{"relayLastHandshakeSeconds":{}}})",
                              std::chrono::duration_cast<std::chrono::seconds>(age).count());
  return response;
}

Response ReadyzResponse(const health::Readiness& readiness) {
  Response response;
  response.status = readiness.ready() ? 200 : 503;
  response.body = readiness.ready() ? view::WordsJson("degraded", readiness.degraded)
                                    : view::WordsJson("refuses", readiness.refuses);
  return response;
}

/// Scrapers on other machines leave a text to those on this one.
std::size_t TextsMaxOf(ListenerId listener) {
  return listener == ListenerId::kHttp ? rcan::kTextsMax : rcan::kTextsMax - rcan::kTextsReserved;
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

Response GetLivez(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = NoParameters(request.query)) return ErrorResponse(*problem);
  fleet::Liveness& liveness = sources.monitor.liveness();
  return LivezResponse(liveness.alive() ? 200 : 503, liveness.age());
}

Response GetReadyz(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = NoParameters(request.query)) return ErrorResponse(*problem);
  return ReadyzResponse(sources.monitor.readiness());
}

Response StartingLivez(const std::string& query) {
  if (const auto problem = NoParameters(query)) return ErrorResponse(*problem);
  return LivezResponse(200, milliseconds(0));
}

Response StartingReadyz(const std::string& query) {
  if (const auto problem = NoParameters(query)) return ErrorResponse(*problem);
  return ReadyzResponse(health::StartingReadiness());
}

Response GetMetrics(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = NoParameters(request.query)) return ErrorResponse(*problem);
  Response response = ScrapeResponse(request.format, request.coding);
  std::string text = sources.metrics(request.format);
  if (request.coding == metrics::Coding::kGzip) {
    metrics::Gzip(text, response.body);
  } else {
    response.body = std::move(text);
  }
  return response;
}

Response GetRobotMetrics(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = NoParameters(request.query)) return ErrorResponse(*problem);
  Response response = ScrapeResponse(request.format, request.coding);
  response.shared_body =
      sources.robots.Text(request.format, request.coding, TextsMaxOf(request.listener),
                          request.caller.scope.Restrict(""));
  if (response.shared_body == nullptr) return TooManyScrapes();
  return response;
}

}  // namespace uplink::http
