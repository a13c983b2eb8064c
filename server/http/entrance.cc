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
  const Site* site = site_.load();
  if (site == nullptr) return AtOnce(FindRoute(path).id, AnswerOfStart(request, path));
  return site->Resolve(request);
}

}  // namespace uplink::http
