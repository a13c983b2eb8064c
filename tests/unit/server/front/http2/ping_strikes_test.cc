#include "server/front/http2/ping_strikes.h"

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

using Verdict = PingStrikes::Verdict;

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr milliseconds kMs{1};

/// Strikes of an idle connection, a millisecond apart from kNow on, the first ping before them.
PingStrikes WithStrikes(int count) {
  PingStrikes strikes;
  for (int i = 0; i <= count; ++i) static_cast<void>(strikes.OnPing(kNow + i * kMs));
  return strikes;
}

TEST(PingStrikes, TheFirstPingIsInOrder) {
  PingStrikes strikes;
  EXPECT_EQ(strikes.OnPing(SteadyTime()), Verdict::kInOrder);
}

TEST(PingStrikes, PingsThatAreTheGapApartAreInOrder) {
  PingStrikes strikes;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(strikes.OnPing(kNow + i * kPingGap), Verdict::kInOrder);
}

TEST(PingStrikes, APingWithinTheGapIsAStrike) {
  PingStrikes strikes;
  ASSERT_EQ(strikes.OnPing(kNow), Verdict::kInOrder);
  EXPECT_EQ(strikes.OnPing(kNow + kPingGap - kMs), Verdict::kForgiven);
}

TEST(PingStrikes, ForgivesTwoAndTheThirdIsTooMany) {
  PingStrikes strikes;
  ASSERT_EQ(strikes.OnPing(kNow), Verdict::kInOrder);
  EXPECT_EQ(strikes.OnPing(kNow + kMs), Verdict::kForgiven);
  EXPECT_EQ(strikes.OnPing(kNow + 2 * kMs), Verdict::kForgiven);
  EXPECT_EQ(strikes.OnPing(kNow + 3 * kMs), Verdict::kTooMany);
}

TEST(PingStrikes, TheGapCountsFromAPingThatWasAStrikeToo) {
  PingStrikes strikes = WithStrikes(0);
  EXPECT_EQ(strikes.OnPing(kNow + kPingGap / 2), Verdict::kForgiven);
  EXPECT_EQ(strikes.OnPing(kNow + kPingGap), Verdict::kForgiven);
}

TEST(PingStrikes, APingInOrderClearsNoStrike) {
  PingStrikes strikes = WithStrikes(2);
  const SteadyTime later = kNow + std::chrono::minutes(1);
  EXPECT_EQ(strikes.OnPing(later), Verdict::kInOrder);
  EXPECT_EQ(strikes.OnPing(later + kMs), Verdict::kTooMany);
}

TEST(PingStrikes, APingAfterOurDataIsInOrder) {
  PingStrikes strikes;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(strikes.OnPing(kNow + i * kMs), Verdict::kInOrder);
    strikes.OnSent();
  }
}

TEST(PingStrikes, OurDataClearsTheStrikes) {
  PingStrikes strikes = WithStrikes(2);
  strikes.OnSent();
  EXPECT_EQ(strikes.OnPing(kNow + 3 * kMs), Verdict::kInOrder);
  EXPECT_EQ(strikes.OnPing(kNow + 4 * kMs), Verdict::kForgiven);
  EXPECT_EQ(strikes.OnPing(kNow + 5 * kMs), Verdict::kForgiven);
  EXPECT_EQ(strikes.OnPing(kNow + 6 * kMs), Verdict::kTooMany);
}

TEST(PingStrikes, EachFurtherStrikeIsTooMany) {
  PingStrikes strikes = WithStrikes(3);
  for (int i = 4; i < 1'000; ++i) ASSERT_EQ(strikes.OnPing(kNow + i * kMs), Verdict::kTooMany) << i;
}

}  // namespace
}  // namespace uplink::front
