#include "server/session/held_back.h"

#include <gtest/gtest.h>

#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {
namespace {

class HoldTest : public ::testing::Test {
 protected:
  HoldTest() {
    limits_.session.in_flight_uplinks_max = 2;
    static_cast<void>(sessions_.Begin(SessionOf(1), clock_.Steady()));
  }
  HeldBack Now(std::size_t outgoing = 0) {
    return HeldBackBy({.sessions = sessions_,
                       .journal = server_.journal(),
                       .throttle = throttle_,
                       .limits = limits_.session,
                       .clock = clock_},
                      outgoing);
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_;
  BenchServer server_{clock_, database_, 1, limits_};
  robot::RobotSessions sessions_;
  Throttle throttle_;
};

TEST_F(HoldTest, AStreamIsHeldBackOnlyAtTheBoundOfItsRobot) {
  EXPECT_EQ(sessions_.AddWaiting(SessionOf(1), 1), 1);
  EXPECT_EQ(Now(), HeldBack::kNone);
  EXPECT_EQ(sessions_.AddWaiting(SessionOf(1), 2), 1);
  EXPECT_EQ(Now(), HeldBack::kInFlight);
}

TEST_F(HoldTest, AStreamWhosePeerDoesNotReadIsHeldBack) {
  EXPECT_EQ(Now(kOutgoingFramesMax - 1), HeldBack::kNone);
  EXPECT_EQ(Now(kOutgoingFramesMax), HeldBack::kUnread);
}

TEST_F(HoldTest, AThrottledStreamIsHeldBackUntilItsEnd) {
  for (std::uint32_t i = 0; i <= kMalformedPerSecondMax; ++i) {
    throttle_.AddMalformed(clock_.Steady());
  }
  EXPECT_EQ(Now(), HeldBack::kMalformed);
  EXPECT_EQ(Now(kOutgoingFramesMax), HeldBack::kUnread) << "the first that applies";
  clock_.Advance(std::chrono::seconds(1));
  EXPECT_EQ(Now(), HeldBack::kNone);
}

}  // namespace
}  // namespace uplink::session
