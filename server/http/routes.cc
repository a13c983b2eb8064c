#include "server/http/routes.h"

#include <array>
#include <optional>
#include <utility>

#include "server/admin/actions.h"
#include "server/http/handlers.h"
#include "server/http/target.h"

namespace uplink::http {
namespace {

constexpr Needs kProbe{Right::kAnyone};
constexpr Needs kScrapeRobots{Right::kScrape};
constexpr Needs kScrapeServer{Right::kScrape, true};
constexpr Needs kReadFleets{Right::kRead};
constexpr Needs kReadServer{Right::kRead, true};
constexpr Needs kOperateServer{Right::kOperate, true};
constexpr Needs kCommandRobot{Right::kCommand};
constexpr Needs kCommandServer{Right::kCommand, true};
constexpr Needs kAdminister{Right::kAdminister, true};

/// A path that changes something.
constexpr Route Command(std::string_view pattern, std::string_view name, Needs needs,
                        Response (*handler)(const Sources&, const RoutedRequest&),
                        std::string_view action) {
  return {pattern, name, Lane::kRead, needs, handler, nullptr, false, action};
}

constexpr auto kRoutes = std::to_array<Route>({
    {"/livez", "livez", Lane::kIo, kProbe, GetLivez},
    {"/readyz", "readyz", Lane::kIo, kProbe, GetReadyz},
    {"/metrics", "metrics", Lane::kMetrics, kScrapeServer, GetMetrics},
    {"/metrics/robots", "metrics_robots", Lane::kScrape, kScrapeRobots, GetRobotMetrics},
    {"/api/v1/status", "status", Lane::kMemory, kReadServer, GetStatus},
    {"/api/v1/openapi.yaml", "openapi", Lane::kMemory, kReadFleets, GetOpenapi, nullptr, true},
    {"/api/v1/config", "config", Lane::kMemory, kOperateServer, GetConfig},
    {"/api/v1/robots", "robots", Lane::kMemory, kReadFleets, GetRobots, RobotsReadStore, true},
    {"/api/v1/robots/{}", "robot", Lane::kRead, kReadFleets, GetRobot, nullptr, true},
    {"/api/v1/robot", "robot_by_ruri", Lane::kRead, kReadFleets, GetRobot, nullptr, true},
    {"/api/v1/robot/story", "robot_story", Lane::kRead, kReadFleets, GetStory},
    {"/api/v1/fleets", "fleets", Lane::kMemory, kReadFleets, GetFleets},
    {"/api/v1/top", "top", Lane::kMemory, kReadFleets, GetTop},
    {"/api/v1/events", "events", Lane::kRead, kReadFleets, GetEvents},
    {"/api/v1/messages", "messages", Lane::kRead, kReadFleets, GetMessages},
    {"/api/v1/connections", "connections", Lane::kRead, kReadFleets, GetConnections},
    {"/api/v1/presence", "presence", Lane::kRead, kReadFleets, GetPresence},
    {"/api/v1/quarantine", "quarantine", Lane::kRead, kReadFleets, GetQuarantine},
    {"/api/v1/gaps", "gaps", Lane::kRead, kReadFleets, GetGaps},
    {"/api/v1/scope-updates", "scope_updates", Lane::kRead, kReadFleets, GetScopeUpdates},
    {"/api/v1/faults", "faults", Lane::kRead, kReadFleets, GetFaults},
    {"/api/v1/missions", "missions", Lane::kRead, kReadFleets, GetMissions},
    {"/api/v1/mission-reports", "mission_reports", Lane::kRead, kReadFleets, GetMissionReports},
    {"/api/v1/operator-requests", "operator_requests", Lane::kRead, kReadFleets,
     GetOperatorRequests},
    {"/api/v1/shapes", "shapes", Lane::kRead, kReadFleets, GetShapes},
    {"/api/v1/objects", "objects", Lane::kRead, kReadFleets, GetObjects},
    {"/api/v1/audit", "audit", Lane::kRead, kAdminister, GetAudit},
    {"/api/v1/certificates/revocations", "revocations", Lane::kRead, kAdminister, GetRevocations},
    Command("/api/v1/robot/block", "robot_block", kCommandRobot, PostBlock, admin::kRobotBlock),
    Command("/api/v1/robot/unblock", "robot_unblock", kCommandRobot, PostUnblock,
            admin::kRobotUnblock),
    Command("/api/v1/robot/disconnect", "robot_disconnect", kCommandRobot, PostDisconnect,
            admin::kRobotDisconnect),
    Command("/api/v1/robot/note", "robot_note", kCommandRobot, PostNote, admin::kRobotNote),
    Command("/api/v1/robot/add", "robot_add", kCommandServer, PostAdd, admin::kRobotAdd),
    Command("/api/v1/faults/acknowledge", "fault_acknowledge", kCommandRobot, PostAcknowledge,
            admin::kFaultAcknowledge),
    Command("/api/v1/certificates/revoke", "certificate_revoke", kAdminister, PostRevoke,
            admin::kCertificateRevoke),
    Command("/api/v1/certificates/unrevoke", "certificate_unrevoke", kAdminister, PostUnrevoke,
            admin::kCertificateUnrevoke),
    Command("/api/v1/reload", "reload", kAdminister, PostReload, admin::kReload),
});

}  // namespace

std::span<const Route> Routes() { return kRoutes; }

RouteId OtherRoute() { return {kRoutes.size()}; }

FoundRoute FindRoute(std::string_view path) {
  for (std::size_t place = 0; place < kRoutes.size(); ++place) {
    std::optional<PathMatch> match = MatchPath(kRoutes[place].pattern, path);
    if (match) return {RouteId{place}, std::move(match->segment)};
  }
  return {};
}

bool Takes(const Route& route, Method method) {
  if (!route.action.empty()) return method == Method::kPost;
  return method == Method::kGet || method == Method::kHead;
}

bool IsMonitoring(RouteId route) {
  if (route.index >= kRoutes.size()) return false;
  const Lane lane = kRoutes[route.index].lane;
  return lane == Lane::kIo || IsScrape(lane);
}

bool IsScrape(Lane lane) { return lane == Lane::kMetrics || lane == Lane::kScrape; }

std::size_t RouteIds() { return kRoutes.size() + 1; }

std::string_view RouteName(RouteId route) {
  return route.index < kRoutes.size() ? kRoutes[route.index].name : "other";
}

}  // namespace uplink::http
