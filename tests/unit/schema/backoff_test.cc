#include "schema/base/backoff.h"

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace uplink {
namespace {

constexpr std::uint64_t kHighest = std::numeric_limits<std::uint64_t>::max();

/// The first number above `from` with which a pause of that many steps is the longest.
constexpr std::uint64_t LastOf(std::uint64_t steps) { return steps - 1; }

TEST(Backoff, DrawsFromTheUpperHalfOfABoundThatDoubles) {
  Backoff lowest({milliseconds(100), milliseconds(1'000)});
  Backoff highest({milliseconds(100), milliseconds(1'000)});
  EXPECT_EQ(lowest.Next(0), milliseconds(50));
  EXPECT_EQ(highest.Next(LastOf(51)), milliseconds(100));
  EXPECT_EQ(lowest.Next(0), milliseconds(100));
  EXPECT_EQ(highest.Next(LastOf(101)), milliseconds(200));
  EXPECT_EQ(lowest.Next(0), milliseconds(200));
}

TEST(Backoff, StaysAtItsLongest) {
  Backoff backoff({milliseconds(100), milliseconds(250)});
  EXPECT_EQ(backoff.Next(0), milliseconds(50));
  EXPECT_EQ(backoff.Next(0), milliseconds(100));
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(backoff.Next(0), milliseconds(125));
    EXPECT_EQ(backoff.Next(LastOf(126)), milliseconds(250));
  }
}

TEST(Backoff, KeepsItsBoundsForAnyRandomNumber) {
  for (const std::uint64_t random : {std::uint64_t{1}, std::uint64_t{12345}, kHighest}) {
    Backoff backoff({milliseconds(3), milliseconds(7)});
    for (int i = 0; i < 10; ++i) {
      const milliseconds pause = backoff.Next(random);
      EXPECT_GE(pause, milliseconds(1));
      EXPECT_LE(pause, milliseconds(7));
    }
  }
}

TEST(Backoff, DoesNotOverflowItsLongest) {
  Backoff backoff({milliseconds(2), milliseconds::max()});
  milliseconds before(0);
  for (int i = 0; i < 100; ++i) {
    const milliseconds pause = backoff.Next(0);
    EXPECT_GE(pause, before);
    before = pause;
  }
  EXPECT_EQ(before, milliseconds::max() / 2);
}

TEST(Backoff, BeginsAnewAfterReset) {
  Backoff backoff({milliseconds(100), milliseconds(1'000)});
  for (int i = 0; i < 5; ++i) static_cast<void>(backoff.Next(0));
  backoff.Reset();
  EXPECT_EQ(backoff.Next(0), milliseconds(50));
}

TEST(BackoffDeathTest, RefusesLimitsThatContradict) {
  EXPECT_DEATH(Backoff({milliseconds(1), milliseconds(10)}), "under 2 ms");
  EXPECT_DEATH(Backoff({milliseconds(10), milliseconds(9)}), "below the first");
}

}  // namespace
}  // namespace uplink
