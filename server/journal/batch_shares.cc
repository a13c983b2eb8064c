#include "server/journal/batch_shares.h"

namespace uplink::journal {

bool BatchShares::Taken::HasRoomFor(std::size_t more, const BatchShare& share) {
  const bool over = records >= share.records_max || bytes + more > share.bytes_max;
  full = full || (records > 0 && over);
  return !full;
}

void BatchShares::Taken::Add(std::size_t more) {
  ++records;
  bytes += more;
}

BatchShares::Admission BatchShares::Admit(const Origin& origin) {
  Taken& robot = robots_[origin.client.get()];
  if (!robot.HasRoomFor(origin.bytes, of_robot_)) return Admission::kRobotWaits;
  if (const GatewayUse* const use = origin.place.gateway().get()) {
    Taken& gateway = gateways_[use];
    if (!gateway.HasRoomFor(origin.bytes, of_gateway_)) return Admission::kGatewayWaits;
    gateway.Add(origin.bytes);
  }
  robot.Add(origin.bytes);
  return Admission::kAdmitted;
}

}  // namespace uplink::journal
