#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/robot/connection_reports.h"
#include "server/transport/peer_connection.h"
#include "storage/connection.h"

namespace uplink::uncrew {

/// Drones of one connection that are reported; a gateway's may speak for many.
inline constexpr std::size_t kDronesPerConnectionMax = 1024;

/// One connection by which drones call: reported for each drone from its first call until the
/// connection ends.
///
/// Thread: confined to the connection's.
class DroneConnections final : public transport::PeerConnection::User {
 public:
  /// The references outlive it; `connection` owns it.
  struct Context {
    const Clock& clock;
    robot::ConnectionReports& reports;
    const transport::PeerConnection& connection;
  };
  explicit DroneConnections(const Context& context) : context_(context) {}

  /// A call for the drone has brought a request of so many bytes.
  void Count(const fleet::RobotPtr& drone, const std::string& gateway, std::size_t bytes);
  void OnConnectionEnd(transport::EndCause cause) override;

 private:
  struct One {
    fleet::RobotPtr drone;
    std::string gateway;
    storage::ConnectionId id{};
    SystemTime began_at;
    SteadyTime kept_at;
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
  };

  [[nodiscard]] storage::ConnectionItem ItemOf(const One& one) const;

  const Context context_;
  /// By RURI.
  std::unordered_map<std::string, One> drones_;
};

}  // namespace uplink::uncrew
