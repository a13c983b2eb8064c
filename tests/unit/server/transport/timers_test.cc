#include "server/transport/timers.h"

#include <gtest/gtest.h>

namespace uplink::transport {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};

TEST(Timers, IsEmptyAtFirst) {
  Timers timers;
  EXPECT_FALSE(timers.next());
  EXPECT_FALSE(timers.PopDue(kNow));
}

TEST(Timers, RoundsUpToTheTick) {
  Timers timers;
  Timers::Slot slot;
  timers.Want(1, slot, kNow + milliseconds(11), kNow);
  EXPECT_EQ(timers.next(), kNow + milliseconds(20));
  EXPECT_FALSE(timers.PopDue(kNow + milliseconds(19)));
  EXPECT_EQ(timers.PopDue(kNow + milliseconds(20)), 1U);
}

TEST(Timers, ADeadlineOnATickStays) {
  Timers timers;
  Timers::Slot slot;
  timers.Want(1, slot, kNow + milliseconds(20), kNow);
  EXPECT_EQ(timers.next(), kNow + milliseconds(20));
}

TEST(Timers, APassedDeadlineIsDueAtTheNextTickNotNow) {
  Timers timers;
  Timers::Slot slot;
  timers.Want(1, slot, kNow - std::chrono::seconds(1), kNow);
  EXPECT_EQ(timers.next(), kNow + kTimerTick);
}

TEST(Timers, AnEarlierDeadlineReplacesTheEntry) {
  Timers timers;
  Timers::Slot slot;
  timers.Want(1, slot, kNow + milliseconds(100), kNow);
  timers.Want(1, slot, kNow + milliseconds(50), kNow);
  EXPECT_EQ(timers.size(), 1U);
  EXPECT_EQ(timers.next(), kNow + milliseconds(50));
}

TEST(Timers, ALaterDeadlineKeepsTheEntry) {
  Timers timers;
  Timers::Slot slot;
  timers.Want(1, slot, kNow + milliseconds(50), kNow);
  timers.Want(1, slot, kNow + milliseconds(100), kNow);
  EXPECT_EQ(timers.size(), 1U);
  EXPECT_EQ(timers.next(), kNow + milliseconds(50));
}

TEST(Timers, GivesOutTheDueOnesInOrder) {
  Timers timers;
  Timers::Slot slots[3];
  timers.Want(1, slots[0], kNow + milliseconds(30), kNow);
  timers.Want(2, slots[1], kNow + milliseconds(10), kNow);
  timers.Want(3, slots[2], kNow + milliseconds(40), kNow);
  EXPECT_EQ(timers.PopDue(kNow + milliseconds(30)), 2U);
  EXPECT_EQ(timers.PopDue(kNow + milliseconds(30)), 1U);
  EXPECT_FALSE(timers.PopDue(kNow + milliseconds(30)));
  EXPECT_EQ(timers.next(), kNow + milliseconds(40));
}

TEST(Timers, ForgetsAStream) {
  Timers timers;
  Timers::Slot slots[2];
  timers.Want(1, slots[0], kNow + milliseconds(10), kNow);
  timers.Want(2, slots[1], kNow + milliseconds(10), kNow);
  timers.Forget(1, slots[0]);
  EXPECT_FALSE(slots[0]);
  EXPECT_EQ(timers.PopDue(kNow + milliseconds(10)), 2U);
  EXPECT_FALSE(timers.PopDue(kNow + milliseconds(10)));
}

}  // namespace
}  // namespace uplink::transport
