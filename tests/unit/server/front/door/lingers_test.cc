#include "server/front/door/lingers.h"

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

KeyDigest Digest(std::uint8_t number) {
  KeyDigest digest{};
  digest.fill(number);
  return digest;
}

TEST(Lingers, AreBoundedInAll) {
  Lingers lingers(2);
  EXPECT_TRUE(lingers.Begin(std::nullopt));
  EXPECT_TRUE(lingers.Begin(Digest(1)));
  EXPECT_FALSE(lingers.Begin(std::nullopt));
  EXPECT_FALSE(lingers.Begin(Digest(2)));
  lingers.End(std::nullopt);
  EXPECT_TRUE(lingers.Begin(Digest(2)));
}

TEST(Lingers, AreBoundedForEachKey) {
  Lingers lingers(100);
  for (std::size_t i = 0; i < Lingers::kLingersPerKeyMax; ++i) {
    EXPECT_TRUE(lingers.Begin(Digest(1)));
  }
  EXPECT_FALSE(lingers.Begin(Digest(1)));
  EXPECT_TRUE(lingers.Begin(Digest(2)));
  EXPECT_TRUE(lingers.Begin(std::nullopt));
  lingers.End(Digest(1));
  EXPECT_TRUE(lingers.Begin(Digest(1)));
  EXPECT_FALSE(lingers.Begin(Digest(1)));
}

TEST(Lingers, WhoWasRefusedCountsNowhere) {
  Lingers lingers(1);
  ASSERT_TRUE(lingers.Begin(std::nullopt));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(lingers.Begin(Digest(1)));
  lingers.End(std::nullopt);
  EXPECT_TRUE(lingers.Begin(Digest(1)));
}

TEST(LingersDeathTest, AnEndWithoutABeginIsOurBug) {
  Lingers lingers(1);
  EXPECT_DEATH(lingers.End(std::nullopt), "did not begin");
}

}  // namespace
}  // namespace uplink::front
