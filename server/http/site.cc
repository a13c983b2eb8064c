#include "server/http/site.h"

#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "schema/json/text.h"
#include "server/http/errors.h"
#include "server/http/form.h"
#include "server/http/negotiate.h"
#include "server/http/parameters.h"
#include "server/http/target.h"

namespace uplink::http {

namespace {

/// What a command was about, by its parameters or else its body; empty if neither names it. No
/// handler has read them.
std::string SubjectOf(const Request& request) {
  Parameters parameters(SplitTarget(request.target).query);
  std::string ruri = parameters.Text("ruri");
  if (!ruri.empty()) return ruri;
  for (const std::string_view member : {"ruri", "keySha256", "sha256", "serial"}) {
    if (auto named = json::StringIn(request.body, member)) return *std::move(named);
  }
  return {};
}

}  // namespace

Resolved AtOnce(RouteId route, Response response) {
  return {route, Lane::kIo, [answer = std::move(response)] { return answer; }};
}

Site::Site(Sources sources) : sources_(std::move(sources)), failures_(sources_.logger) {}

Resolved Site::Resolve(const Request& request) const {
  const Target target = SplitTarget(request.target);
  FoundRoute found = FindRoute(target.path);
  if (found.id.index >= Routes().size()) return AtOnce(found.id, NoSuchPath(target.path));
  const Route& route = Routes()[found.id.index];
  if (!Takes(route, request.method)) {
    return AtOnce(found.id, MethodNotAllowed(!route.action.empty()));
  }
  return Resolve(found.id, {.segment = std::move(found.segment),
                            .query = std::string(target.query),
                            .format = FormatFor(request.accept),
                            .coding = CodingFor(request.accept_encoding),
                            .lines = PrefersLines(request.accept),
                            .if_none_match = request.if_none_match,
                            .listener = request.listener,
                            .caller = request.caller,
                            .from = request.from,
                            .content_type = request.content_type,
                            .body = request.body});
}

Resolved Site::Resolve(RouteId id, RoutedRequest request) const {
  const Route& route = Routes()[id.index];
  const bool reads = route.reads_store != nullptr && route.reads_store(request);
  return {id, reads ? Lane::kRead : route.lane,
          [this, &route, request = std::move(request)] { return Run(route, request); }};
}

void Site::NoteForbidden(const Request& request, RouteId route) const {
  const std::string_view action = Routes()[route.index].action;
  if (action.empty()) return;
  sources_.commands.NoteForbidden(admin::AskerOf(request.caller, request.from), action,
                                  SubjectOf(request));
}

Response Site::Run(const Route& route, const RoutedRequest& request) const {
  Response response;
  // What a library throws under a handler (memory) ends here.
  try {
    response = route.handler(sources_, request);
    if (route.lane == Lane::kMemory || route.lane == Lane::kRead) {
      response = InFormOf(request, route, std::move(response));
    }
  } catch (const std::exception& error) {
    response = ErrorResponse(absl::InternalError(error.what()));
  }
  if (!response.cause.empty()) {
    failures_.Write(log::Level::kWarn, "http_answer_failed",
                    {{"route", route.name}, {"status", response.status}, {"why", response.cause}});
  }
  return response;
}

}  // namespace uplink::http
