#include "server/http/answers.h"

#include <utility>

#include "server/http/errors.h"
#include "storage/reader.h"

namespace uplink::http {

Response JsonResponse(absl::StatusOr<std::string> json) {
  if (!json.ok()) return ErrorResponse(json.status());
  Response response;
  response.body = *std::move(json);
  return response;
}

std::uint32_t ReadPageSize(Parameters& parameters) {
  return parameters.Number("pageSize", storage::kPageSizeDefault, storage::kPageSizeMax);
}

}  // namespace uplink::http
