#include "server/front/door/evictions.h"

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kSecond{1};

KeyDigest Digest(std::uint32_t number) {
  KeyDigest digest{};
  digest[0] = static_cast<std::uint8_t>(number);
  digest[1] = static_cast<std::uint8_t>(number >> 8U);
  return digest;
}

TEST(Evictions, CountWithinAMinute) {
  Evictions evictions;
  EXPECT_EQ(evictions.Note(Digest(1), kNow), 1U);
  EXPECT_EQ(evictions.Note(Digest(1), kNow + kSecond), 2U);
  EXPECT_EQ(evictions.Note(Digest(1), kNow + kSecond * 60 - milliseconds(1)), 3U);
  EXPECT_EQ(evictions.Note(Digest(1), kNow + kSecond * 60), 3U) << "the first is a minute old";
  EXPECT_EQ(evictions.Note(Digest(1), kNow + kSecond * 3600), 1U);
}

TEST(Evictions, CountUpToWhatIsFlagged) {
  Evictions evictions;
  for (std::size_t i = 1; i < kEvictionsFlagged; ++i) EXPECT_EQ(evictions.Note(Digest(1), kNow), i);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(evictions.Note(Digest(1), kNow), kEvictionsFlagged);
  EXPECT_EQ(evictions.Note(Digest(1), kNow + kSecond * 60), 1U);
}

TEST(Evictions, KeysAreCountedApart) {
  Evictions evictions;
  evictions.Note(Digest(1), kNow);
  EXPECT_EQ(evictions.Note(Digest(2), kNow), 1U);
  EXPECT_EQ(evictions.Note(Digest(1), kNow), 2U);
}

TEST(Evictions, PastTheirBoundTheKeyWhoseLastIsLongestAgoIsForgotten) {
  Evictions evictions;
  for (std::uint32_t key = 0; key < Evictions::kKeysMax; ++key) evictions.Note(Digest(key), kNow);
  EXPECT_EQ(evictions.Note(Digest(0), kNow), 2U);
  evictions.Note(Digest(Evictions::kKeysMax), kNow);
  EXPECT_EQ(evictions.Note(Digest(0), kNow), 3U);
  EXPECT_EQ(evictions.Note(Digest(1), kNow), 1U) << "it was forgotten";
}

}  // namespace
}  // namespace uplink::front
