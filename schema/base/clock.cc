#include "schema/base/clock.h"

#include <ctime>

#include "schema/base/check.h"

namespace uplink {

SteadyTime SystemClock::Steady() const { return std::chrono::steady_clock::now(); }

SystemTime SystemClock::System() const {
  return std::chrono::time_point_cast<milliseconds>(std::chrono::system_clock::now());
}

SteadyTime SystemBootClock::Boot() const {
  timespec time{};
  UPLINK_CHECK(::clock_gettime(CLOCK_BOOTTIME, &time) == 0, "Linux has this clock since 2.6.39");
  return SteadyTime(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace uplink
