#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "server/session/intake.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {
namespace {

/// A robot, and what keeps all of its messages.
class FindBlockOfAllTest : public ::testing::Test {
 protected:
  HeldBack Of(std::size_t outgoing = 0) {
    return FindBlockOfAll(robot_, outgoing, clock_.Steady()).by;
  }

  testing::ManualClock clock_;
  const robot::PresenceChanged changed_;
  robot::Robot robot_{std::make_shared<const model::RobotId>(model::RobotId{std::string(kRobot)}),
                      clock_.Steady(), clock_, changed_};
};

TEST_F(FindBlockOfAllTest, AStreamWhosePeerDoesNotReadIsHeldBack) {
  EXPECT_EQ(Of(kOutgoingFramesMax - 1), HeldBack::kNone);
  EXPECT_EQ(Of(kOutgoingFramesMax), HeldBack::kUnread);
}

TEST_F(FindBlockOfAllTest, AThrottledStreamIsHeldBackUntilItsEnd) {
  for (std::uint32_t i = 0; i <= robot::kRejectsPerSecondMax; ++i) {
    robot_.throttle.Add(clock_.Steady());
  }
  EXPECT_EQ(Of(), HeldBack::kMalformed);
  EXPECT_EQ(Of(kOutgoingFramesMax), HeldBack::kUnread) << "the first that applies";
  clock_.Advance(std::chrono::seconds(1));
  EXPECT_EQ(Of(), HeldBack::kNone);
}

}  // namespace
}  // namespace uplink::session
