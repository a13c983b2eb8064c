#include "server/front/http2/frame_rates.h"

#include <set>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kSecond{1};

/// How many of so many frames that come at once are within the limit.
std::uint32_t TakeAtOnce(FrameRates& rates, FrameKind kind, std::uint32_t frames, SteadyTime now) {
  std::uint32_t taken = 0;
  for (std::uint32_t i = 0; i < frames; ++i) {
    if (rates.Take(kind, now)) ++taken;
  }
  return taken;
}

class FrameRatesOfAKind : public ::testing::TestWithParam<FrameLimit> {};

INSTANTIATE_TEST_SUITE_P(All, FrameRatesOfAKind, ::testing::ValuesIn(kFrameLimits),
                         [](const auto& each) { return std::string(each.param.label); });

TEST_P(FrameRatesOfAKind, TakesABurstAndNoMore) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  EXPECT_EQ(TakeAtOnce(rates, kind, burst, kNow), burst);
  EXPECT_FALSE(rates.Take(kind, kNow));
}

TEST_P(FrameRatesOfAKind, TakesTheNextOneAfterItsInterval) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  TakeAtOnce(rates, kind, burst, kNow);
  const SteadyTime next = kNow + SteadyTime::duration(kSecond) / rate;
  EXPECT_FALSE(rates.Take(kind, next - SteadyTime::duration(1)));
  EXPECT_TRUE(rates.Take(kind, next));
  EXPECT_FALSE(rates.Take(kind, next));
}

TEST_P(FrameRatesOfAKind, TakesItsRateForEver) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  const auto interval = SteadyTime::duration(kSecond) / rate;
  for (std::uint32_t i = 0; i < 3 * burst; ++i) {
    ASSERT_TRUE(rates.Take(kind, kNow + interval * i)) << i;
  }
  EXPECT_EQ(TakeAtOnce(rates, kind, burst, kNow + interval * (3 * burst)), burst);
}

TEST_P(FrameRatesOfAKind, APauseGivesNoMoreThanABurst) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  TakeAtOnce(rates, kind, burst, kNow);
  EXPECT_EQ(TakeAtOnce(rates, kind, 2 * burst, kNow + std::chrono::hours(24)), burst);
}

TEST_P(FrameRatesOfAKind, APeerWithManyStreamsHasABurstForThemWhereTheyCostIt) {
  constexpr std::uint32_t kTimes = 8;
  FrameRates rates(kTimes * kRobotStreamsMax);
  const FrameLimit& limit = GetParam();
  const std::uint32_t burst =
      limit.scope != FrameScope::kConnection ? kTimes * limit.burst : limit.burst;
  EXPECT_EQ(TakeAtOnce(rates, limit.kind, 2 * burst, kNow), burst);
  const std::uint32_t rate = limit.scope != FrameScope::kConnection
                                 ? limit.rate + (kTimes - 1) * kRobotStreamsMax
                                 : limit.rate;
  // Intervals are whole nanoseconds: of a second a frame may be left over.
  EXPECT_NEAR(TakeAtOnce(rates, limit.kind, 2 * burst, kNow + kSecond), rate, 1)
      << "one more per second for each stream";
}

TEST(FrameRates, TheDronesOfAFullGatewayMayPublishAllTypesOnceASecondForEver) {
  constexpr std::uint32_t kDrones = 256;
  FrameRates rates(kDrones, kDrones * kCallsPerStream);
  for (int second = 0; second < 60; ++second) {
    EXPECT_EQ(
        TakeAtOnce(rates, FrameKind::kHeaders, kDrones * kCallsPerStream, kNow + second * kSecond),
        kDrones * kCallsPerStream)
        << second;
  }
}

TEST(FrameRates, EachStreamOfAGatewayMayBeOpenedAndResetOnceASecondForEver) {
  constexpr std::uint32_t kStreams = 256;
  FrameRates rates(kStreams);
  for (int second = 0; second < 600; ++second) {
    for (const FrameKind kind : {FrameKind::kHeaders, FrameKind::kReset}) {
      ASSERT_EQ(TakeAtOnce(rates, kind, kStreams, kNow + second * kSecond), kStreams) << second;
    }
  }
}

// --- Answers to what we send ---

void NoteSent(FrameRates& rates, std::uint32_t frames, SteadyTime now) {
  for (std::uint32_t i = 0; i < frames; ++i) rates.NoteSent(now);
}

/// How many of so many frames that come at once may be answers to ours.
std::uint32_t TakeForSentAtOnce(FrameRates& rates, FrameKind kind, std::uint32_t frames,
                                SteadyTime now) {
  std::uint32_t taken = 0;
  for (std::uint32_t i = 0; i < frames; ++i) {
    if (rates.TakeForSent(kind, now)) ++taken;
  }
  return taken;
}

TEST_P(FrameRatesOfAKind, AnswersToWhatWeSentComeBesidesTheLimit) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  constexpr std::uint32_t kSent = 1'000;
  EXPECT_FALSE(rates.TakeForSent(kind, kNow));
  NoteSent(rates, kSent, kNow);
  EXPECT_EQ(TakeForSentAtOnce(rates, kind, 3 * kSent, kNow), kSent * per_sent);
  EXPECT_EQ(TakeAtOnce(rates, kind, burst + 1, kNow), burst);
}

TEST_P(FrameRatesOfAKind, OfWhatWeSentOnlySoMuchIsLeftOver) {
  FrameRates rates;
  const auto& [kind, rate, burst, scope, per_sent, cause, label] = GetParam();
  NoteSent(rates, 100'000, kNow);
  EXPECT_EQ(TakeForSentAtOnce(rates, kind, 10'000, kNow), per_sent == 0 ? 0 : kForSentMax);
}

TEST(FrameRates, ClientsAnswerByPingsAndWindows) {
  for (const FrameLimit& limit : kFrameLimits) {
    const bool answers = limit.kind == FrameKind::kPing || limit.kind == FrameKind::kWindowUpdate;
    EXPECT_EQ(limit.per_sent > 0, answers) << limit.label;
  }
}

TEST(FrameRates, AnAnswerComesSoonAfterWhatWeSentLast) {
  FrameRates rates;
  NoteSent(rates, 10, kNow);
  EXPECT_TRUE(rates.TakeForSent(FrameKind::kPing, kNow + kForSentWait));
  const SteadyTime late = kNow + kForSentWait + SteadyTime::duration(1);
  EXPECT_FALSE(rates.TakeForSent(FrameKind::kPing, late));
  rates.NoteSent(late);
  EXPECT_EQ(TakeForSentAtOnce(rates, FrameKind::kPing, 10, late), 1U);
}

TEST(FrameRates, APeerWithOneStreamHasItsFrame) {
  FrameRates rates(1);
  for (const FrameLimit& limit : kFrameLimits) EXPECT_TRUE(rates.Take(limit.kind, kNow));
}

TEST(FrameRates, OneThatIsPastTheLimitCostsNothing) {
  FrameRates rates;
  TakeAtOnce(rates, FrameKind::kReset, 100'000, kNow);
  EXPECT_EQ(TakeAtOnce(rates, FrameKind::kReset, 100, kNow + kSecond), 20U);
}

TEST(FrameRates, KindsDoNotShareALimit) {
  FrameRates rates;
  TakeAtOnce(rates, FrameKind::kSettings, 100, kNow);
  EXPECT_FALSE(rates.Take(FrameKind::kSettings, kNow));
  for (const FrameLimit& limit : kFrameLimits) {
    if (limit.kind != FrameKind::kSettings) {
      EXPECT_TRUE(rates.Take(limit.kind, kNow)) << limit.label;
    }
  }
}

TEST(FrameRates, HoldsFromTheFirstMomentOfTheClock) {
  FrameRates rates;
  EXPECT_EQ(TakeAtOnce(rates, FrameKind::kSettings, 100, SteadyTime()), 20U);
}

TEST(FrameRates, EachKindHasALabelOfItsOwn) {
  std::set<std::string_view> labels;
  for (const FrameLimit& limit : kFrameLimits) labels.insert(limit.label);
  EXPECT_EQ(labels.size(), kFrameKinds);
  EXPECT_EQ(LimitOf(FrameKind::kEmptyData).label, "empty_data");
}

}  // namespace
}  // namespace uplink::front
