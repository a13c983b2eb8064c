#include "server/robot/reconnects.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

class ReconnectsTest : public ::testing::Test {
 protected:
  /// The waits of so many streams that each end at once, in milliseconds.
  std::vector<std::int64_t> Waits(std::size_t streams) {
    std::vector<std::int64_t> waits;
    for (; streams > 0; --streams) {
      const auto arrival = reconnects_.Arrive(clock_.Steady(), {});
      waits.push_back(arrival->delay.count());
      if (arrival->delay > milliseconds(0)) reconnects_.EndWait();
    }
    return waits;
  }

  testing::ManualClock clock_;
  Reconnects reconnects_;
};

TEST_F(ReconnectsTest, TenOfAMinuteWaitForNothing) {
  EXPECT_THAT(Waits(kStreamsPerMinuteMax), Each(0));
}

TEST_F(ReconnectsTest, EachOneMoreWaitsTwiceAsLongUpToFiveSeconds) {
  static_cast<void>(Waits(kStreamsPerMinuteMax));
  EXPECT_THAT(Waits(9), ElementsAre(100, 200, 400, 800, 1600, 3200, 5000, 5000, 5000));
}

TEST_F(ReconnectsTest, TheWaitFallsAsTheMinuteEmpties) {
  static_cast<void>(Waits(5));
  clock_.Advance(std::chrono::seconds(30));
  static_cast<void>(Waits(8));
  EXPECT_THAT(Waits(1), ElementsAre(800));
  clock_.Advance(std::chrono::seconds(30));
  EXPECT_THAT(Waits(1), ElementsAre(1600)) << "all are of this minute still";
  clock_.Advance(milliseconds(1));
  EXPECT_THAT(Waits(1), ElementsAre(100)) << "the first five are not: eleven are";
  clock_.Advance(std::chrono::seconds(30));
  EXPECT_THAT(Waits(1), ElementsAre(0));
}

TEST_F(ReconnectsTest, HoweverManyCameAMinuteOfRestFreesTheRobot) {
  static_cast<void>(Waits(1'000));
  clock_.Advance(std::chrono::minutes(1));
  EXPECT_THAT(Waits(1), ElementsAre(5000));
  clock_.Advance(std::chrono::minutes(1) + milliseconds(1));
  EXPECT_THAT(Waits(1), ElementsAre(0));
}

TEST_F(ReconnectsTest, FourWaitAtOnceAndNoMore) {
  static_cast<void>(Waits(kStreamsPerMinuteMax));
  for (std::size_t i = 0; i < kStreamsWaitingMax; ++i) {
    EXPECT_TRUE(reconnects_.Arrive(clock_.Steady(), {}).has_value());
  }
  EXPECT_FALSE(reconnects_.Arrive(clock_.Steady(), {}).has_value());
  reconnects_.EndWait();
  EXPECT_TRUE(reconnects_.Arrive(clock_.Steady(), {}).has_value());
  EXPECT_FALSE(reconnects_.Arrive(clock_.Steady(), {}).has_value());
  clock_.Advance(std::chrono::minutes(2));
  EXPECT_EQ(reconnects_.Arrive(clock_.Steady(), {})->delay, milliseconds(0))
      << "who need not wait comes past those that do";
}

TEST_F(ReconnectsTest, AStreamThatCameLaterIsNotTakenOver) {
  const auto first = reconnects_.Arrive(clock_.Steady(), {});
  const auto second = reconnects_.Arrive(clock_.Steady(), {});
  EXPECT_TRUE(reconnects_.MayAttach(second->number));
  EXPECT_FALSE(reconnects_.MayAttach(first->number));
  EXPECT_TRUE(reconnects_.MayAttach(reconnects_.Arrive(clock_.Steady(), {})->number));
}

TEST_F(ReconnectsTest, LimitsCanBeOthers) {
  const ReconnectLimits limits{.per_minute = 1, .delay_max = milliseconds(150)};
  EXPECT_EQ(reconnects_.Arrive(clock_.Steady(), limits)->delay, milliseconds(0));
  EXPECT_EQ(reconnects_.Arrive(clock_.Steady(), limits)->delay, milliseconds(100));
  EXPECT_EQ(reconnects_.Arrive(clock_.Steady(), limits)->delay, milliseconds(150));
}

}  // namespace
}  // namespace uplink::robot
