#pragma once

#include <array>
#include <string_view>

namespace uplink::rpc {

/// A method, and the path of HTTP that does the same. Immutable.
struct PathMethod {
  std::string_view name;
  std::string_view path;
};

/// The unary methods of FleetView.
inline constexpr auto kViewMethods = std::to_array<PathMethod>({
    {"ListRobots", "/api/v1/robots"},
    {"GetRobot", "/api/v1/robot"},
    {"ListFaults", "/api/v1/faults"},
    {"ListEvents", "/api/v1/events"},
    {"ListMessages", "/api/v1/messages"},
    {"ListMissions", "/api/v1/missions"},
    {"ListMissionReports", "/api/v1/mission-reports"},
    {"ListOperatorRequests", "/api/v1/operator-requests"},
    {"ListShapes", "/api/v1/shapes"},
    {"ListObjects", "/api/v1/objects"},
    {"ListConnections", "/api/v1/connections"},
    {"GetRobotStory", "/api/v1/robot/story"},
    {"ListPresenceChanges", "/api/v1/presence"},
    {"ListQuarantine", "/api/v1/quarantine"},
    {"ListGaps", "/api/v1/gaps"},
    {"ListScopeUpdates", "/api/v1/scope-updates"},
    {"ListFleets", "/api/v1/fleets"},
    {"ListTop", "/api/v1/top"},
    {"ListCandidates", "/api/v1/candidates"},
    {"GetStatus", "/api/v1/status"},
    {"GetConfig", "/api/v1/config"},
});

/// Those of FleetAdmin.
inline constexpr auto kAdminMethods = std::to_array<PathMethod>({
    {"BlockRobot", "/api/v1/robot/block"},
    {"UnblockRobot", "/api/v1/robot/unblock"},
    {"DisconnectRobot", "/api/v1/robot/disconnect"},
    {"NoteRobot", "/api/v1/robot/note"},
    {"AddRobot", "/api/v1/robot/add"},
    {"RevokeCertificate", "/api/v1/certificates/revoke"},
    {"UnrevokeCertificate", "/api/v1/certificates/unrevoke"},
    {"ListRevocations", "/api/v1/certificates/revocations"},
    {"AcknowledgeFault", "/api/v1/faults/acknowledge"},
    {"ListAudit", "/api/v1/audit"},
    {"Reload", "/api/v1/reload"},
});

}  // namespace uplink::rpc
