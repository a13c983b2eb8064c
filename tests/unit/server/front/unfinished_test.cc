#include "server/front/unfinished.h"

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr std::size_t kBytesMax = 100;
constexpr SteadyTime kStart{};

SteadyTime At(int ms) { return kStart + milliseconds(ms); }

TEST(Unfinished, NobodyIsTooSlowAtTheLimit) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(1, 0, 40, At(1));
  unfinished.Set(2, 0, 60, At(2));
  EXPECT_EQ(unfinished.bytes(), kBytesMax);
  EXPECT_FALSE(unfinished.TooSlow());
}

TEST(Unfinished, PastItTheOneThatBeganFirstIs) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(2, 0, 1, At(1));
  unfinished.Set(1, 0, 50, At(2));
  unfinished.Set(3, 0, 50, At(3));
  EXPECT_EQ(unfinished.TooSlow(), 2U) << "how much it holds is no measure of how slow it is";
  unfinished.Set(2, 0, 0, At(4));
  EXPECT_FALSE(unfinished.TooSlow());
}

TEST(Unfinished, AMessageKeepsTheTimeOfItsBeginning) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(1, 0, 10, At(1));
  unfinished.Set(2, 0, 10, At(2));
  unfinished.Set(1, 0, 95, At(9));
  EXPECT_EQ(unfinished.TooSlow(), 1U);
}

TEST(Unfinished, AnotherMessageOfTheCallBeginsAnew) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(1, 0, 10, At(1));
  unfinished.Set(2, 0, 10, At(2));
  unfinished.Set(1, 0, 0, At(3));
  unfinished.Set(1, 0, 95, At(4));
  EXPECT_EQ(unfinished.TooSlow(), 2U);
}

// A busy stream always has one that is unfinished, each time another.
TEST(Unfinished, TheNextMessageOfTheCallBeginsAnewThoughNoMomentWasWithoutOne) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(1, 0, 10, At(1));
  unfinished.Set(2, 0, 10, At(2));
  unfinished.Set(1, 1, 95, At(3));
  EXPECT_EQ(unfinished.TooSlow(), 2U);
  unfinished.Set(1, 1, 0, At(4));
  EXPECT_EQ(unfinished.bytes(), 10U);
  EXPECT_FALSE(unfinished.TooSlow());
}

TEST(Unfinished, CallsWithoutAnyAreNotKept) {
  Unfinished unfinished(kBytesMax);
  unfinished.Set(1, 0, 0, At(1));
  EXPECT_EQ(unfinished.bytes(), 0U);
  EXPECT_FALSE(unfinished.TooSlow());
}

}  // namespace
}  // namespace uplink::front
