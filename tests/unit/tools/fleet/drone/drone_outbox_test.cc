#include <gtest/gtest.h>

#include "tools/uplink-fleet/drone/outbox.h"

namespace uplink::synthetic {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr milliseconds kLong{10'000};

AvatarCall Call(std::uint64_t number, bool live, std::size_t line = 0) {
  AvatarCall call;
  call.number = number;
  call.line = line;
  call.live = live;
  return call;
}

class Outbox : public ::testing::Test {
 protected:
  /// The number of the call that leaves then; 0: none.
  [[nodiscard]] std::uint64_t Leaves(SteadyTime now = kNow) {
    const auto leaving = outbox.Next(now);
    if (leaving) tries = leaving->tries;
    return leaving ? leaving->call.number : 0;
  }

  DroneOutbox outbox{2, 1};
  std::size_t tries = 0;
};

TEST_F(Outbox, CallsOfALineFollowEachOther) {
  outbox.Add(Call(1, false), kNow);
  outbox.Add(Call(2, false), kNow);
  outbox.Add(Call(3, false, 1), kNow);
  EXPECT_EQ(Leaves(), 1U);
  EXPECT_EQ(Leaves(), 3U);
  EXPECT_EQ(Leaves(), 0U);
  outbox.Answered(0);
  EXPECT_EQ(Leaves(), 2U);
  outbox.Answered(0);
  outbox.Answered(1);
  EXPECT_TRUE(outbox.empty());
}

TEST_F(Outbox, WhatIsLostLeavesAgainAfterAPause) {
  outbox.Add(Call(1, false), kNow);
  EXPECT_EQ(Leaves(), 1U);
  outbox.Lost(0, kNow);
  EXPECT_EQ(Leaves(), 0U);
  EXPECT_TRUE(outbox.IsBusy(0));
  EXPECT_EQ(Leaves(kNow + kLong), 1U);
  EXPECT_EQ(tries, 2U);
}

TEST_F(Outbox, ANewerLiveSampleTakesThePlaceOfOneThatWaits) {
  outbox.Add(Call(1, true), kNow);
  outbox.Add(Call(2, true), kNow);
  EXPECT_EQ(Leaves(), 2U);
  outbox.Add(Call(3, true), kNow);
  outbox.Lost(0, kNow);
  EXPECT_EQ(Leaves(kNow + kLong), 3U);
  EXPECT_EQ(tries, 1U);
  outbox.Answered(0);
  EXPECT_TRUE(outbox.empty());
}

}  // namespace
}  // namespace uplink::synthetic
