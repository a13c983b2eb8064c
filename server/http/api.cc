// The handlers of /api/v1 that say how the server does.
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/openapi_text.h"
#include "server/http/parameters.h"
#include "server/view/config_json.h"
#include "server/view/json.h"

namespace uplink::http {

Response GetStatus(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = Parameters(request.query).Problem()) return ErrorResponse(*problem);
  return JsonResponse(
      view::Encode(request.form, sources.queries.Status(), sources.monitor.readiness().all()));
}

Response GetConfig(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = Parameters(request.query).Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::Encode(request.form, sources.in_effect));
}

Response GetOpenapi(const Sources& /*sources*/, const RoutedRequest& request) {
  if (const auto problem = Parameters(request.query).Problem()) return ErrorResponse(*problem);
  Response response;
  response.content_type = "application/yaml";
  response.body = OpenapiText();
  return response;
}

}  // namespace uplink::http
