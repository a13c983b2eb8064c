#include "server/robot/throttle.h"

#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

class ThrottleTest : public ::testing::Test {
 protected:
  void Add(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) throttle_.Add(now_);
  }
  /// How long until the stream goes on; zero if it does now.
  [[nodiscard]] SteadyTime::duration wait() const {
    return throttle_.end() && *throttle_.end() > now_ ? *throttle_.end() - now_
                                                      : SteadyTime::duration(0);
  }

  SteadyTime now_ = testing::ManualClock().Steady();
  Throttle throttle_;
};

TEST_F(ThrottleTest, AsManyAsOneSecondMayHavePassAtOnce) {
  Add(kRejectsPerSecondMax);
  EXPECT_FALSE(throttle_.end().has_value());
  Add(1);
  EXPECT_EQ(wait(), milliseconds(kRejectsAtOnce + 1));
}

TEST_F(ThrottleTest, ThoseThatAreTooManyComeAFewAtATime) {
  Add(kRejectsPerSecondMax + 1);
  for (int turn = 0; turn < 3; ++turn) {
    now_ += wait();
    Add(kRejectsAtOnce);
    EXPECT_EQ(wait(), SteadyTime::duration(0)) << turn;
    Add(1);
    EXPECT_EQ(wait(), milliseconds(kRejectsAtOnce + 1)) << turn;
  }
}

TEST_F(ThrottleTest, AfterAPauseAsManyPassAsAtFirst) {
  Add(kRejectsPerSecondMax + 1);
  now_ += milliseconds(1001);
  Add(kRejectsPerSecondMax);
  EXPECT_EQ(wait(), SteadyTime::duration(0));
  Add(1);
  EXPECT_GT(wait(), SteadyTime::duration(0));
}

}  // namespace
}  // namespace uplink::robot
