#pragma once

#include <functional>

#include "server/http/handlers.h"
#include "server/http/message.h"
#include "server/http/routes.h"
#include "server/log/rate_limited.h"

namespace uplink::http {

/// An answer that is found but not computed yet. A value; `run` does not throw.
struct Resolved {
  RouteId route = OtherRoute();
  Lane lane = Lane::kIo;
  std::function<Response()> run;
};

/// An answer that is there already.
[[nodiscard]] Resolved AtOnce(RouteId route, Response response);

/// Which route answers a request (routes.cc lists them); no sockets. Thread-safe after its making.
class Site final {
 public:
  explicit Site(Sources sources);
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  /// Finds the route: never fails, since errors are answers too. HEAD is answered like GET; the
  /// connection leaves the body out. The site outlives the answer.
  [[nodiscard]] Resolved Resolve(const Request& request) const;
  /// The same of a question that came another way: its route is one of Routes().
  [[nodiscard]] Resolved Resolve(RouteId id, RoutedRequest request) const;
  /// The caller, which showed who it is, may not ask for the route: the audit tells it of a
  /// command. Never waits.
  void NoteForbidden(const Request& request, RouteId route) const;

 private:
  /// Answers, and logs what failed.
  [[nodiscard]] Response Run(const Route& route, const RoutedRequest& request) const;

  const Sources sources_;
  mutable log::RateLimited failures_;
};

}  // namespace uplink::http
