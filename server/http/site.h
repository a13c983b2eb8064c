#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "server/health/monitor.h"
#include "server/http/message.h"
#include "server/http/parameters.h"
#include "server/http/probe.h"
#include "server/http/scrape.h"
#include "server/rcan/scrape.h"
#include "server/view/queries.h"

namespace uplink::http {

/// Which thread answers: probes and our own scrape at once, on the io thread; what may wait for the
/// store on the thread that reads; the robots' scrape on one of its own.
enum class Lane : std::uint8_t { kIo, kRead, kScrape };

/// An answer that is found but not computed yet. A value; `run` does not throw.
struct Resolved {
  RouteId route = RouteId::kOther;
  Lane lane = Lane::kIo;
  std::function<Response()> run;
};

/// All paths and what they answer; no sockets. Thread-safe after its making.
class Site final {
 public:
  Site(view::Queries& queries, health::Monitor& monitor, const Scrape& scrape,
       rcan::RobotScrape& robots);
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  /// Finds the route: never fails, since errors are answers too. HEAD is answered like GET; the
  /// transport leaves the body out.
  [[nodiscard]] Resolved Resolve(const Request& request) const;

 private:
  struct Call {
    /// The `{}` of the route's path, decoded.
    std::string segment;
    std::string query;
    metrics::Format format = metrics::Format::kText;
    metrics::Coding coding = metrics::Coding::kPlain;
  };
  using Handler = Response (Site::*)(const Call&) const;
  struct Route {
    std::string_view pattern;
    RouteId id;
    Lane lane;
    Handler handler;
  };
  static const std::array<Route, 16> kRoutes;

  [[nodiscard]] Response Livez(const Call& call) const;
  [[nodiscard]] Response Readyz(const Call& call) const;
  [[nodiscard]] Response Metrics(const Call& call) const;
  [[nodiscard]] Response MetricsOfRobots(const Call& call) const;
  [[nodiscard]] Response Status(const Call& call) const;
  [[nodiscard]] Response Robots(const Call& call) const;
  [[nodiscard]] Response Robot(const Call& call) const;
  [[nodiscard]] Response Events(const Call& call) const;
  [[nodiscard]] Response Messages(const Call& call) const;
  [[nodiscard]] Response Presence(const Call& call) const;
  [[nodiscard]] Response Quarantine(const Call& call) const;
  [[nodiscard]] Response Gaps(const Call& call) const;
  [[nodiscard]] Response Faults(const Call& call) const;
  [[nodiscard]] Response Missions(const Call& call) const;
  [[nodiscard]] Response Shapes(const Call& call) const;
  [[nodiscard]] Response Objects(const Call& call) const;

  view::Queries& queries_;
  health::Monitor& monitor_;
  const Scrape& scrape_;
  rcan::RobotScrape& robots_;
};

}  // namespace uplink::http
