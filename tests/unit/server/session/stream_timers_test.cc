#include "server/session/stream_timers.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::session {
namespace {

TEST(StreamTimersTest, NothingIsDueUntilItIsSet) {
  const SteadyTime now = testing::ManualClock().Steady();
  const StreamTimers timers;
  EXPECT_FALSE(timers.Due(Timer::kAck, now));
  EXPECT_FALSE(timers.Next().has_value());
}

TEST(StreamTimersTest, OneIsDueFromItsTimeOnUntilItIsCleared) {
  const SteadyTime now = testing::ManualClock().Steady();
  StreamTimers timers;
  timers.Set(Timer::kAck, now + milliseconds(10));
  EXPECT_FALSE(timers.Due(Timer::kAck, now + milliseconds(9)));
  EXPECT_TRUE(timers.Due(Timer::kAck, now + milliseconds(10)));
  EXPECT_FALSE(timers.Due(Timer::kHello, now + milliseconds(10)));
  timers.Clear(Timer::kAck);
  EXPECT_FALSE(timers.is_set(Timer::kAck));
  EXPECT_FALSE(timers.Due(Timer::kAck, now + milliseconds(10)));
}

TEST(StreamTimersTest, TheEarliestIsNext) {
  const SteadyTime now = testing::ManualClock().Steady();
  StreamTimers timers;
  timers.Set(Timer::kReadAgain, now + milliseconds(30));
  timers.Set(Timer::kHello, now + milliseconds(20));
  timers.Set(Timer::kSettle, now + milliseconds(40));
  EXPECT_EQ(timers.Next(), now + milliseconds(20));
  timers.Clear(Timer::kHello);
  EXPECT_EQ(timers.Next(), now + milliseconds(30));
}

}  // namespace
}  // namespace uplink::session
