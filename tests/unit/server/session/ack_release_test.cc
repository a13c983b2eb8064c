// When the next Ack is due, and what it says.
#include "server/session/ack_release.h"

#include "tests/unit/server/session/stream_part_test.h"

namespace uplink::session {
namespace {

class AckReleaseTest : public StreamPartTest {
 protected:
  std::string Release(const robot::Progress& progress) { return ToLine(ack_.Release(progress)); }
  /// How many latencies were observed.
  [[nodiscard]] std::uint64_t Observed() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i <= metrics::kLatencyBoundsSeconds.size(); ++i) {
      sum += probe_.ack_seconds.count(i);
    }
    return sum;
  }

  AckRelease ack_{context_, timers_};
};

TEST_F(AckReleaseTest, NothingIsDueAtFirst) {
  EXPECT_FALSE(ack_.due());
  EXPECT_FALSE(timers_.Next().has_value());
}

TEST_F(AckReleaseTest, ItIsDueAtTheBoundOfMessages) {
  ack_.AddProcessed({.messages = kAckMessages - 1});
  EXPECT_FALSE(ack_.due());
  ack_.AddProcessed({.messages = 1});
  EXPECT_TRUE(ack_.due());
}

TEST_F(AckReleaseTest, TheCountBeginsAgainWithEachAck) {
  ack_.AddProcessed({.messages = kAckMessages + 1});
  static_cast<void>(Release({.through = 65, .judged = 65}));
  EXPECT_FALSE(ack_.due());
  ack_.AddProcessed({.messages = kAckMessages - 1});
  EXPECT_FALSE(ack_.due());
}

TEST_F(AckReleaseTest, TheTimeRunsFromTheFirstMessageAndEndsWithTheAck) {
  const SteadyTime at = clock_.Steady() + limits_.session.ack_interval;
  ack_.AddProcessed({});
  EXPECT_FALSE(timers_.is_set(Timer::kAck)) << "no message, no Ack";
  ack_.AddProcessed({.messages = 1});
  EXPECT_EQ(timers_.at(Timer::kAck), at);
  clock_.Advance(milliseconds(1));
  ack_.AddProcessed({.messages = 1});
  EXPECT_EQ(timers_.at(Timer::kAck), at);
  static_cast<void>(Release({.through = 2, .judged = 2}));
  EXPECT_FALSE(timers_.is_set(Timer::kAck));
}

TEST_F(AckReleaseTest, ASettledMessageThatCameAgainMakesItDue) {
  ack_.AddProcessed({.messages = 1, .ack_owed = true});
  EXPECT_TRUE(ack_.due());
}

TEST_F(AckReleaseTest, OnlyProgressBeyondTheLastAckMakesItDue) {
  static_cast<void>(Release({.through = 5, .judged = 5}));
  ack_.AddProgress({.through = 5, .judged = 9});
  EXPECT_FALSE(ack_.due());
  ack_.AddProgress({.through = 6, .judged = 9});
  EXPECT_TRUE(ack_.due());
}

TEST_F(AckReleaseTest, WelcomeAndTheEndMakeItDueWithoutAMessage) {
  ack_.MakeDue();
  EXPECT_TRUE(ack_.due());
  EXPECT_EQ(Release({}), "ack 0 judged 0");
  EXPECT_FALSE(ack_.due());
}

TEST_F(AckReleaseTest, AnAckNeverSaysLessThanTheOneBefore) {
  EXPECT_EQ(Release({.through = 5, .judged = 8}), "ack 5 judged 8");
  EXPECT_EQ(Release({.through = 3, .judged = 9}), "ack 5 judged 9");
  EXPECT_EQ(Release({.through = 6, .judged = 2}), "ack 6 judged 9");
  EXPECT_EQ(probe_.acks_total.value(), 3);
}

TEST_F(AckReleaseTest, LatencyIsObservedOncePerReleasedMessageWhenTheAckGoesOut) {
  const SteadyTime arrived = clock_.Steady();
  ack_.AddReleased({arrived});
  ack_.AddProgress({.released = {arrived, arrived}});
  clock_.Advance(milliseconds(40));
  EXPECT_EQ(Observed(), 0U);
  static_cast<void>(Release({.through = 3, .judged = 3}));
  EXPECT_EQ(Observed(), 3U);
  EXPECT_NEAR(probe_.ack_seconds.sum(), 0.12, 1e-6);
  static_cast<void>(Release({.through = 3, .judged = 3}));
  EXPECT_EQ(Observed(), 3U);
}

TEST_F(AckReleaseTest, ArrivalsPastTheBoundAreLetGo) {
  const SteadyTime arrived = clock_.Steady();
  ack_.AddReleased(std::vector<SteadyTime>(kReleasedMax - 1, arrived));
  ack_.AddReleased({arrived, arrived});
  ack_.AddReleased({arrived});
  static_cast<void>(Release({}));
  EXPECT_EQ(Observed(), kReleasedMax);
}

}  // namespace
}  // namespace uplink::session
