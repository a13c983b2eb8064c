#include "server/robot/throttle.h"

#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

TEST(ThrottleTest, EndsASecondAfterTheFirstOfTooManyMalformedMessages) {
  const SteadyTime now = testing::ManualClock().Steady();
  Throttle throttle;
  for (std::uint32_t i = 0; i < kMalformedPerSecondMax; ++i) throttle.AddMalformed(now);
  EXPECT_FALSE(throttle.end().has_value());
  throttle.AddMalformed(now + milliseconds(999));
  EXPECT_EQ(throttle.end(), now + milliseconds(1000));
}

TEST(ThrottleTest, ANewSecondCountsFromZero) {
  const SteadyTime now = testing::ManualClock().Steady();
  Throttle throttle;
  for (std::uint32_t i = 0; i <= kMalformedPerSecondMax; ++i) throttle.AddMalformed(now);
  throttle.AddMalformed(now + milliseconds(1000));
  EXPECT_FALSE(throttle.end().has_value());
}

}  // namespace
}  // namespace uplink::robot
