#include "server/front/door/evictions.h"

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kSecond{1};

constexpr KeyDigest kKey{1};

TEST(Evictions, CountWithinAMinute) {
  Evictions evictions;
  EXPECT_EQ(evictions.Note(kKey, kNow), 1U);
  EXPECT_EQ(evictions.Note(kKey, kNow + kSecond), 2U);
  EXPECT_EQ(evictions.Note(kKey, kNow + kSecond * 60 - milliseconds(1)), 3U);
  EXPECT_EQ(evictions.Note(kKey, kNow + kSecond * 60), 3U) << "the first is a minute old";
  EXPECT_EQ(evictions.Note(kKey, kNow + kSecond * 3600), 1U);
}

TEST(Evictions, CountUpToWhatIsFlagged) {
  Evictions evictions;
  for (std::size_t i = 1; i < kEvictionsFlagged; ++i) EXPECT_EQ(evictions.Note(kKey, kNow), i);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(evictions.Note(kKey, kNow), kEvictionsFlagged);
  EXPECT_EQ(evictions.Note(kKey, kNow + kSecond * 60), 1U);
}

}  // namespace
}  // namespace uplink::front
