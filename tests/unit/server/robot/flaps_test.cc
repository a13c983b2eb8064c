#include "server/robot/flaps.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

class FlapsTest : public ::testing::Test {
 protected:
  bool Look() {
    flaps_.Reach(clock_.Steady(), limits_);
    return flaps_.flapping();
  }

  testing::ManualClock clock_;
  Flaps::Limits limits_{.changes = 3, .window = std::chrono::minutes(5)};
  Flaps flaps_;
};

TEST_F(FlapsTest, TakesAsManyChangesAsConfigured) {
  EXPECT_FALSE(Look());
  flaps_.Add(clock_.Steady());
  flaps_.Add(clock_.Steady());
  EXPECT_FALSE(Look());
  flaps_.Add(clock_.Steady());
  EXPECT_TRUE(Look());
}

TEST_F(FlapsTest, TakesThemWithinTheWindow) {
  flaps_.Add(clock_.Steady());
  clock_.Advance(limits_.window - milliseconds(1));
  flaps_.Add(clock_.Steady());
  flaps_.Add(clock_.Steady());
  EXPECT_TRUE(Look());
  clock_.Advance(milliseconds(1));
  EXPECT_FALSE(Look()) << "the first is too old";
}

TEST_F(FlapsTest, KeepsNoMoreThanItsBound) {
  limits_.changes = Flaps::kChangesMax;
  for (std::size_t i = 0; i < 3 * Flaps::kChangesMax; ++i) flaps_.Add(clock_.Steady());
  EXPECT_TRUE(Look());
  clock_.Advance(limits_.window);
  EXPECT_FALSE(Look());
}

}  // namespace
}  // namespace uplink::robot
