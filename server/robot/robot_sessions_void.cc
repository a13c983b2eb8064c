// What of a robot's sessions is void, and why.
#include "server/robot/outcome.h"
#include "server/robot/robot_sessions.h"

namespace uplink::robot {

StreamRef RobotSessions::OnFenced(metrics::Ledger& ledger) {
  return VoidAndStop(Standing::kSuperseded, ledger);
}

StreamRef RobotSessions::OnWentBack(metrics::Ledger& ledger) {
  return VoidAndStop(Standing::kWentBack, ledger);
}

StreamRef RobotSessions::VoidAndStop(Standing standing, metrics::Ledger& ledger) {
  std::size_t waited = 0;
  StreamRef wake;
  {
    const std::lock_guard lock(mutex_);
    waited = Void();
    fleet_words_.Answered();
    takeover_.Stop(standing);
    wake = takeover_.current();
  }
  Publish(SupersededCounts(waited), ledger);
  return wake;
}

std::optional<FleetWords::Refused> RobotSessions::OnOtherFleet(std::uint64_t open_id,
                                                               metrics::Ledger& ledger) {
  std::size_t waited = 0;
  std::optional<FleetWords::Refused> refused;
  {
    const std::lock_guard lock(mutex_);
    if (opening_.IsLast(open_id)) refused = fleet_words_.Refuse();
    if (!refused) return refused;
    waited = Void();
    takeover_.Refuse(refused->stream);
  }
  Publish(SupersededCounts(waited), ledger);
  return refused;
}

std::size_t RobotSessions::Void() {
  const std::size_t waiting = sessions_.waiting();
  in_flight_.fetch_sub(waiting);
  record_bytes_.store(0);
  sessions_.Clear();
  last_session_.reset();
  settled_taken_.reset();
  opening_.Forget();
  resends_.Begin();
  generation_.fetch_add(1);
  return waiting;
}

}  // namespace uplink::robot
