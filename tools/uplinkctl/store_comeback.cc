#include "tools/uplinkctl/store_comeback.h"

#include <chrono>
#include <thread>

#include <fmt/core.h>

#include "tools/uplinkctl/command.h"

namespace uplink::ctl {
namespace {

constexpr std::chrono::seconds kComeBackWait{2};
constexpr milliseconds kLookEvery{100};

/// False also if the store cannot be asked: that changes nothing of what was deleted.
bool CameBack(storage::RobotRemoval& removal, const std::string& ruri, bool stream_ended,
              const Clock& clock) {
  const SteadyTime until =
      clock.Steady() + (stream_ended ? kComeBackWait : std::chrono::seconds(0));
  while (true) {
    const auto hold = removal.HoldOf(ruri);
    if (!hold.ok()) return false;
    if (*hold || clock.Steady() >= until) return hold->has_value();
    std::this_thread::sleep_for(kLookEvery);
  }
}

}  // namespace

int ReportRemoved(storage::RobotRemoval& removal, const std::string& ruri, bool stream_ended,
                  const Clock& clock) {
  if (CameBack(removal, ruri, stream_ended, clock)) {
    fmt::print("removed, then came back: it spoke again, and the store has it as a new robot\n");
  } else {
    fmt::print("forgotten\n");
  }
  return kExitDone;
}

}  // namespace uplink::ctl
