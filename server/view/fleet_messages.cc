#include <cstdint>
#include <tuple>

#include "server/view/messages.h"
#include "server/view/timestamps.h"

// Fleets in figures, the robots that send most, and those that were refused.
namespace uplink::view {

v1::Fleet ToMessage(const FleetView& fleet) {
  v1::Fleet message;
  message.set_fleet(fleet.fleet);
  message.set_robots(fleet.robots);
  message.set_online(fleet.presence.online);
  message.set_offline(fleet.presence.offline);
  message.set_unknown(fleet.presence.unknown);
  message.set_estops(fleet.estops);
  if (fleet.active_faults) {
    v1::FaultTally& tally = *message.mutable_active_faults();
    const FaultCounts::BySeverity& counts = *fleet.active_faults;
    static_assert(std::tuple_size_v<FaultCounts::BySeverity> == 5, "one field for each");
    tally.set_info(counts[0]);
    tally.set_minor(counts[1]);
    tally.set_major(counts[2]);
    tally.set_critical(counts[3]);
    tally.set_unrecognized(counts[4]);
  }
  message.mutable_agent_versions()->insert(fleet.agent_versions.begin(),
                                           fleet.agent_versions.end());
  message.mutable_software_versions()->insert(fleet.software_versions.begin(),
                                              fleet.software_versions.end());
  return message;
}

v1::TopRobot ToMessage(const fleet::TopSenders::Sender& sender) {
  v1::TopRobot message;
  message.set_ruri(sender.ruri);
  message.set_fleet(sender.fleet);
  message.set_per_second(sender.per_second);
  return message;
}

v1::Candidate ToMessage(const fleet::Candidate& candidate) {
  v1::Candidate message;
  message.set_ruri(candidate.robot.ruri);
  message.set_fleet(candidate.robot.fleet);
  message.set_gateway(candidate.gateway);
  SetTime(message, &v1::Candidate::mutable_first_refused_at, candidate.first_at);
  SetTime(message, &v1::Candidate::mutable_last_refused_at, candidate.last_at);
  message.set_refused(static_cast<std::int64_t>(candidate.refused));
  return message;
}

}  // namespace uplink::view
