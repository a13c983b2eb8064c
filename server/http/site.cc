#include "server/http/site.h"

#include <exception>
#include <optional>
#include <utility>

#include "server/http/errors.h"
#include "server/http/negotiate.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

Resolved AtOnce(RouteId route, Response response) {
  return {route, Lane::kIo, [answer = std::move(response)] { return answer; }};
}

}  // namespace

Site::Site(Sources sources) : sources_(std::move(sources)) {}

Resolved Site::Resolve(const Request& request) const {
  const Target target = SplitTarget(request.target);
  for (std::size_t place = 0; place < Routes().size(); ++place) {
    const Route& route = Routes()[place];
    std::optional<PathMatch> match = MatchPath(route.pattern, target.path);
    if (!match) continue;
    if (request.method == Method::kOther) return AtOnce(RouteId{place}, MethodNotAllowed());
    RoutedRequest routed{std::move(match->segment), std::string(target.query),
                         FormatFor(request.accept), CodingFor(request.accept_encoding)};
    return {RouteId{place}, route.lane,
            [this, handler = route.handler, routed = std::move(routed)] {
              // What a library throws under a handler (memory) ends here.
              try {
                return handler(sources_, routed);
              } catch (const std::exception& error) {
                return ErrorResponse(absl::InternalError(error.what()));
              }
            }};
  }
  return AtOnce(OtherRoute(), NoSuchPath(target.path));
}

}  // namespace uplink::http
