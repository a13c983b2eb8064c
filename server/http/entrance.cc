#include "server/http/entrance.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/http/errors.h"
#include "server/http/header_text.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

Response AnswerOfStart(const Request& request, RouteId route) {
  if (route.index >= Routes().size()) return Starting();
  const Route& asked = Routes()[route.index];
  if (!Takes(asked, request.method)) return MethodNotAllowed(!asked.action.empty());
  const Target target = SplitTarget(request.target);
  const std::string query(target.query);
  if (target.path == "/livez") return StartingLivez(query);
  if (target.path == "/readyz") return StartingReadyz(query);
  return Starting();
}

/// Commands come from programs, and from pages of this very host and port. The browser knows best;
/// behind a proxy the header Host may be another.
bool MayChange(const Request& request) {
  if (!request.fetch_site.empty()) {
    return SameWord(request.fetch_site, "same-origin") || SameWord(request.fetch_site, "none");
  }
  return !request.origin || KnownHosts::IsSameOrigin(*request.origin, request.host.value_or(""));
}

}  // namespace

std::optional<Response> Entrance::Refusal(const Request& request, RouteId route) const {
  if (request.listener == ListenerId::kMetrics) return std::nullopt;
  const bool data = !IsMonitoring(route);
  const bool covered =
      data || (covered_ == Covered::kDataAndScrapes && IsScrape(Routes()[route.index].lane));
  const std::shared_ptr<const KnownHosts> known = hosts();
  if (covered && request.host && !known->Has(*request.host)) return MisdirectedRequest();
  if (!data) return std::nullopt;
  if (SameWord(request.fetch_site, "cross-site")) return ForeignPage();
  if (request.origin && !known->HasOrigin(*request.origin, request.host.value_or(""))) {
    return ForeignPage();
  }
  if (request.method == Method::kPost && !MayChange(request)) return ForeignPage();
  if (request.monitoring_only) return TooManyConnections();
  return std::nullopt;
}

Resolved Entrance::Resolve(Request request) const {
  const bool host_missing = request.host_required && !request.host;
  std::optional<AbsoluteTarget> whole;
  if (IsAbsolute(request.target)) {
    whole = SplitAbsolute(request.target);
    if (!whole) return AtOnce(OtherRoute(), BadRequest(400, "the target names no host"));
    request.host = std::move(whole->authority);
    request.target = std::move(whole->target);
  }
  const auto [path, query] = SplitTarget(request.target);
  const RouteId route = FindRoute(path).id;
  if (request.listener == ListenerId::kMetrics && !IsMonitoring(route)) {
    return AtOnce(OtherRoute(), NoSuchPath(path));
  }
  if (host_missing) {
    return AtOnce(route, BadRequest(400, "an HTTP/1.1 request has one Host header"));
  }
  if (HasToken(query)) return AtOnce(route, TokenInAddress());
  if (std::optional<Response> refusal = Refusal(request, route)) {
    return AtOnce(route, *std::move(refusal));
  }
  const Site* const site = site_.load();
  if (guard_ != nullptr) {
    Guard::Answer answer = guard_->Ask(request, route);
    request.caller = std::move(answer.caller);
    if (answer.refusal) {
      if (site != nullptr && answer.known) site->NoteForbidden(request, route);
      return AtOnce(route, *std::move(answer.refusal));
    }
  }
  if (site == nullptr) return AtOnce(route, AnswerOfStart(request, route));
  return site->Resolve(request);
}

}  // namespace uplink::http
