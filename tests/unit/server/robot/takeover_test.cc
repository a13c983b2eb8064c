#include "server/robot/takeover.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SilentInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

class RobotTakeoverTest : public ::testing::Test {
 protected:
  loop::StreamRef Stream(std::uint64_t number) { return {.inbox = &inbox_, .stream = number}; }
  Takeover::Attached Attach(std::uint64_t number) {
    return takeover_.Attach(Stream(number), clock_.Steady(), clock_.System());
  }

  testing::ManualClock clock_;
  SilentInbox inbox_;
  Takeover takeover_;
};

TEST_F(RobotTakeoverTest, TheFirstStreamIsTheRobots) {
  const Takeover::Attached attached = Attach(1);
  EXPECT_EQ(attached.standing, Standing::kCurrent);
  EXPECT_FALSE(attached.took_over);
  EXPECT_THAT(attached.to_wake, IsEmpty());
  EXPECT_EQ(takeover_.current(), Stream(1));
  EXPECT_EQ(takeover_.connected_since(), clock_.System());
}

TEST_F(RobotTakeoverTest, ANewerStreamWakesTheOlderOnesAndWaits) {
  Attach(1);
  EXPECT_THAT(Attach(2).to_wake, ElementsAre(Stream(1)));
  const Takeover::Attached attached = Attach(3);
  EXPECT_EQ(attached.standing, Standing::kWaiting);
  EXPECT_TRUE(attached.took_over);
  EXPECT_THAT(attached.to_wake, ElementsAre(Stream(1), Stream(2)));
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kSuperseded);
  EXPECT_EQ(takeover_.StandingOf(Stream(2)), Standing::kSuperseded);
  EXPECT_EQ(takeover_.StandingOf(Stream(3)), Standing::kWaiting);
}

TEST_F(RobotTakeoverTest, TheOneThatWaitsIsTheRobotsFromWhenItCame) {
  Attach(1);
  clock_.Advance(std::chrono::seconds(5));
  Attach(2);
  const SystemTime came = clock_.System();
  clock_.Advance(std::chrono::seconds(5));
  EXPECT_EQ(takeover_.Detach(Stream(1)), Stream(2));
  EXPECT_EQ(takeover_.StandingOf(Stream(2)), Standing::kCurrent);
  EXPECT_EQ(takeover_.connected_since(), came);
}

TEST_F(RobotTakeoverTest, TheGatewayOfTheLastStreamStaysKnown) {
  EXPECT_EQ(takeover_.gateway(), "");
  static_cast<void>(takeover_.Attach(Stream(1), clock_.Steady(), clock_.System(), "a"));
  takeover_.Detach(Stream(1));
  EXPECT_EQ(takeover_.gateway(), "a");
  static_cast<void>(takeover_.Attach(Stream(2), clock_.Steady(), clock_.System(), "b"));
  static_cast<void>(takeover_.Attach(Stream(3), clock_.Steady(), clock_.System(), "c"));
  EXPECT_EQ(takeover_.gateway(), "b");
  takeover_.Detach(Stream(2));
  EXPECT_EQ(takeover_.gateway(), "c");
  takeover_.Detach(Stream(3));
  Attach(4);
  EXPECT_EQ(takeover_.gateway(), "") << "the robot speaks by itself now";
}

TEST_F(RobotTakeoverTest, OneThatGivesUpWaitingLeavesTheOlderSuperseded) {
  Attach(1);
  Attach(2);
  EXPECT_FALSE(takeover_.Detach(Stream(2)));
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kSuperseded);
  EXPECT_FALSE(takeover_.Detach(Stream(1)));
  EXPECT_FALSE(takeover_.current());
}

TEST_F(RobotTakeoverTest, AnotherProcessSupersedesTheCurrentStream) {
  takeover_.Stop(Standing::kSuperseded);
  EXPECT_EQ(Attach(1).standing, Standing::kCurrent) << "there was none to supersede";
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kCurrent);
  takeover_.Stop(Standing::kSuperseded);
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kSuperseded);
}

TEST_F(RobotTakeoverTest, AStreamThatIsEndedOnRequestMakesRoomForTheNext) {
  takeover_.End(Standing::kEnded);
  EXPECT_EQ(Attach(1).standing, Standing::kCurrent) << "there was none to end";
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kCurrent);
  takeover_.End(Standing::kEnded);
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kEnded);
  EXPECT_EQ(Attach(2).standing, Standing::kWaiting);
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kSuperseded);
  takeover_.End(Standing::kEnded);
  EXPECT_EQ(takeover_.StandingOf(Stream(1)), Standing::kSuperseded) << "it was told so already";
  takeover_.Detach(Stream(1));
  EXPECT_EQ(takeover_.StandingOf(Stream(2)), Standing::kCurrent);
}

TEST_F(RobotTakeoverTest, AStreamThatIsEndedOnRequestKnowsWhy) {
  for (const Standing standing : {Standing::kBlocked, Standing::kDisconnected}) {
    EXPECT_EQ(Attach(1).standing, Standing::kCurrent);
    takeover_.End(standing);
    EXPECT_EQ(takeover_.StandingOf(Stream(1)), standing);
    takeover_.Detach(Stream(1));
  }
}

TEST_F(RobotTakeoverTest, MoreThanTheLimitInAMinuteIsContestedUntilASweepAfterIt) {
  Attach(0);
  for (std::uint32_t i = 1; i <= kTakeoversPerMinuteMax; ++i) EXPECT_FALSE(Attach(i).contested);
  EXPECT_FALSE(takeover_.contested());
  EXPECT_TRUE(Attach(100).contested);
  EXPECT_FALSE(Attach(101).contested) << "told once, when it begins";
  EXPECT_TRUE(takeover_.contested());
  clock_.Advance(std::chrono::seconds(61));
  takeover_.Sweep(clock_.Steady());
  EXPECT_FALSE(takeover_.contested());
}

}  // namespace
}  // namespace uplink::robot
