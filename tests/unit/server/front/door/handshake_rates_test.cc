#include "server/front/door/handshake_rates.h"

#include <chrono>
#include <cstdint>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/front/door/handshake_queue.h"

namespace uplink::front {
namespace {

using ::testing::ElementsAre;

constexpr milliseconds kBetween{1000 / kHandshakesPerSecond};

SourceAddress From(std::uint32_t number) {
  return SourceAddress::Of(in_addr{.s_addr = htonl(number)});
}

const SourceAddress kA = From(0x0A000001);
const SourceAddress kB = From(0x0A000002);

bool IsWithin(const HandshakeRates& rates, const SourceAddress& source, SteadyTime now) {
  return rates.WithinAt(source, now) <= now;
}

TEST(HandshakeRates, ASourceMayHaveSomeAtOnceAndThenSoManyPerSecond) {
  HandshakeRates rates;
  SteadyTime now{};
  for (int i = 0; i < kHandshakesAtOnce; ++i) {
    EXPECT_TRUE(IsWithin(rates, kA, now)) << i;
    rates.Note(kA, now);
  }
  EXPECT_FALSE(IsWithin(rates, kA, now));
  EXPECT_TRUE(IsWithin(rates, kB, now)) << "another source";
  EXPECT_EQ(rates.WithinAt(kA, now), now + kBetween);
  now += kBetween;
  EXPECT_TRUE(IsWithin(rates, kA, now));
  rates.Note(kA, now);
  EXPECT_FALSE(IsWithin(rates, kA, now));
}

TEST(HandshakeRates, WhatWasOverTheRateIsNotHeldAgainstItForLonger) {
  HandshakeRates rates;
  const SteadyTime now{};
  for (int i = 0; i < 1000 * kHandshakesAtOnce; ++i) rates.Note(kA, now);
  EXPECT_LE(rates.WithinAt(kA, now), now + 2 * kBetween);
}

TEST(HandshakeRates, ForgetsWhoHasUsedNothingOfLate) {
  HandshakeRates rates;
  SteadyTime now{};
  for (std::uint32_t i = 0; i < 100; ++i) rates.Note(From(i), now);
  EXPECT_EQ(rates.size(), 100U);
  now += kBetween;
  rates.Note(kA, now);
  EXPECT_EQ(rates.size(), 1U);
}

TEST(HandshakeRates, RemembersSoManySourcesAndNoMore) {
  HandshakeRates rates;
  const SteadyTime now{};
  for (int i = 0; i < kHandshakesAtOnce; ++i) rates.Note(kA, now);
  for (std::uint32_t i = 1; i < kRatedSourcesMax; ++i) rates.Note(From(i), now);
  EXPECT_EQ(rates.size(), kRatedSourcesMax);
  EXPECT_FALSE(IsWithin(rates, kA, now));
  rates.Note(From(kRatedSourcesMax), now);
  EXPECT_EQ(rates.size(), kRatedSourcesMax);
  EXPECT_TRUE(IsWithin(rates, kA, now)) << "it was noted least recently";
}

/// A queue with one place, where each handshake ends as soon as it has begun.
class RatedQueue : public ::testing::Test {
 protected:
  void Arrive(const SourceAddress& source, std::uint64_t first, std::uint64_t count,
              Rank rank = Rank::kStranger) {
    for (std::uint64_t id = first; id < first + count; ++id) {
      ASSERT_EQ(queue_.Arrive(id, source, rank, now_), std::nullopt);
    }
  }
  /// Whose handshakes come next.
  std::vector<std::uint64_t> Serve(std::size_t count) {
    std::vector<std::uint64_t> served;
    while (served.size() < count) {
      const auto id = queue_.Next(now_);
      if (!id) break;
      served.push_back(*id);
      queue_.Ended(*id);
    }
    return served;
  }

  SteadyTime now_{};
  HandshakeQueue queue_{{.under_way_max = 8, .waiting_max = 1000}};
};

/// One source's handshakes fail at once, another's are slow and keep places: without a rate each
/// place that is freed would go to the first.
TEST_F(RatedQueue, WhoFailsAtOnceAgainAndAgainTakesNotEveryPlaceOfWhoIsSlow) {
  Arrive(kB, 1, 6);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(queue_.Next(now_));
  Arrive(kA, 100, 100);
  const std::vector<std::uint64_t> served = Serve(kHandshakesAtOnce + 1);
  EXPECT_EQ(served.front(), 100U);
  EXPECT_EQ(served.back(), 5U) << "the other source's turn";
}

TEST_F(RatedQueue, ASourceOverTheRateIsServedIfNobodyElseWaits) {
  Arrive(kA, 1, 200);
  EXPECT_EQ(Serve(200).size(), 200U);
}

TEST_F(RatedQueue, ASourceIsWithinTheRateAgainWhileItWaits) {
  Arrive(kA, 1, kHandshakesAtOnce + 2);
  ASSERT_EQ(Serve(kHandshakesAtOnce).size(), static_cast<std::size_t>(kHandshakesAtOnce));
  Arrive(kB, 100, 3);
  EXPECT_THAT(Serve(1), ElementsAre(100));
  now_ += kBetween;
  EXPECT_THAT(Serve(1), ElementsAre(kHandshakesAtOnce + 1)) << "it was served less recently";
}

TEST_F(RatedQueue, AKnownSourceOverTheRateComesBeforeStrangers) {
  Arrive(kA, 1, kHandshakesAtOnce + 2, Rank::kKnown);
  ASSERT_EQ(Serve(kHandshakesAtOnce).size(), static_cast<std::size_t>(kHandshakesAtOnce));
  Arrive(kB, 100, 3);
  EXPECT_THAT(Serve(1), ElementsAre(100)) << "every fourth place";
  EXPECT_THAT(Serve(1), ElementsAre(kHandshakesAtOnce + 1));
}

TEST_F(RatedQueue, NoMoreAreAdmittedThanThreadsCanBegin) {
  HandshakeQueue queue({.under_way_max = 8, .waiting_max = 10, .unbegun_max = 2});
  for (std::uint64_t id = 1; id <= 4; ++id) {
    ASSERT_EQ(queue.Arrive(id, kA, Rank::kStranger, now_), std::nullopt);
  }
  EXPECT_EQ(queue.Next(now_), 1U);
  EXPECT_EQ(queue.Next(now_), 2U);
  EXPECT_EQ(queue.Next(now_), std::nullopt);
  EXPECT_FALSE(queue.pressed()) << "places are free";
  queue.Began(1);
  queue.Began(1);  // told twice
  queue.Began(4);  // it waits
  EXPECT_EQ(queue.Next(now_), 3U);
  EXPECT_EQ(queue.Next(now_), std::nullopt);
  queue.Ended(2);  // it never began
  EXPECT_EQ(queue.Next(now_), 4U);
}

}  // namespace
}  // namespace uplink::front
