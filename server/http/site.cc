#include "server/http/site.h"

#include <exception>
#include <utility>

#include "server/http/errors.h"
#include "server/http/negotiate.h"
#include "server/http/target.h"

namespace uplink::http {

Resolved AtOnce(RouteId route, Response response) {
  return {route, Lane::kIo, [answer = std::move(response)] { return answer; }};
}

Site::Site(Sources sources) : sources_(std::move(sources)) {}

Resolved Site::Resolve(const Request& request) const {
  const Target target = SplitTarget(request.target);
  FoundRoute found = FindRoute(target.path);
  if (found.id.index >= Routes().size()) return AtOnce(found.id, NoSuchPath(target.path));
  if (request.method == Method::kOther) return AtOnce(found.id, MethodNotAllowed());
  const Route& route = Routes()[found.id.index];
  RoutedRequest routed{std::move(found.segment), std::string(target.query),
                       FormatFor(request.accept), CodingFor(request.accept_encoding)};
  return {found.id, route.lane, [this, handler = route.handler, routed = std::move(routed)] {
            // What a library throws under a handler (memory) ends here.
            try {
              return handler(sources_, routed);
            } catch (const std::exception& error) {
              return ErrorResponse(absl::InternalError(error.what()));
            }
          }};
}

}  // namespace uplink::http
