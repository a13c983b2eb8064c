#include "schema/base/clock.h"

namespace uplink {

SteadyTime SystemClock::Steady() const { return std::chrono::steady_clock::now(); }

SystemTime SystemClock::System() const {
  return std::chrono::time_point_cast<milliseconds>(std::chrono::system_clock::now());
}

}  // namespace uplink
