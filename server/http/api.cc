// The handlers of /api/v1 that say how the server does.
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/view/json.h"

namespace uplink::http {

Response GetStatus(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = Parameters(request.query).Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::ToJson(sources.queries.Status(), sources.monitor.readiness().all()));
}

}  // namespace uplink::http
