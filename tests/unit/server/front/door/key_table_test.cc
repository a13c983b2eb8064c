#include "server/front/door/key_table.h"

#include <optional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kSecond{1};

KeyDigest Digest(std::uint8_t number) {
  KeyDigest digest{};
  digest.fill(number);
  return digest;
}

/// Connections 1, 2, ... of key 1, one second apart from kNow on, with a stream each.
void AddStreaming(KeyTable& table, std::uint64_t count) {
  for (std::uint64_t id = 1; id <= count; ++id) {
    const SteadyTime at = kNow + kSecond * static_cast<int>(id);
    ASSERT_EQ(table.Add(Digest(1), id, count, at), std::nullopt);
    table.SetStreams(id, 1);
  }
}

TEST(KeyTable, PastItTheOldestWithoutAStreamGoes) {
  KeyTable table;
  AddStreaming(table, 4);
  table.SetStreams(2, 0);
  table.SetStreams(3, 0);
  table.NoteHeard(2, kNow + kSecond * 60);
  EXPECT_EQ(table.Add(Digest(1), 5, 4, kNow + kSecond * 61), 2U);
  EXPECT_EQ(table.connections(), 4U);
}

TEST(KeyTable, PastItTheOneHeardLeastRecentlyGoesIfAllHaveAStream) {
  KeyTable table;
  AddStreaming(table, 3);
  table.NoteHeard(1, kNow + kSecond * 10);
  table.NoteHeard(3, kNow + kSecond * 11);
  EXPECT_EQ(table.Add(Digest(1), 4, 3, kNow + kSecond * 12), 2U);
}

TEST(KeyTable, WhoWasNeverHeardCountsFromWhenItCame) {
  KeyTable table;
  AddStreaming(table, 3);
  EXPECT_EQ(table.Add(Digest(1), 4, 3, kNow + kSecond * 12), 1U);
}

TEST(KeyTable, AnEarlierTimeOfAnotherThreadTakesNothingBack) {
  KeyTable table;
  AddStreaming(table, 2);
  table.NoteHeard(1, kNow + kSecond * 10);
  table.NoteHeard(1, kNow);
  EXPECT_EQ(table.Add(Digest(1), 3, 2, kNow + kSecond * 12), 2U);
}

TEST(KeyTable, TheNewcomerStaysAlthoughItHasNoStreamYet) {
  KeyTable table;
  AddStreaming(table, 1);
  EXPECT_EQ(table.Add(Digest(1), 2, 1, kNow + kSecond * 2), 1U);
  EXPECT_EQ(table.connections(), 1U);
}

TEST(KeyTable, TheNewcomerGoesIfNoneIsAllowed) {
  KeyTable table;
  EXPECT_EQ(table.Add(Digest(1), 1, 0, kNow), 1U);
  EXPECT_EQ(table.connections(), 0U);
  EXPECT_EQ(table.keys(), 0U);
}

TEST(KeyTable, OtherKeysHaveTheirOwnMaximum) {
  KeyTable table;
  AddStreaming(table, 1);
  EXPECT_EQ(table.Add(Digest(2), 2, 1, kNow), std::nullopt);
  EXPECT_EQ(table.keys(), 2U);
}

TEST(KeyTable, AMaximumThatHasShrunkLetsAKeyHaveNoMoreThanItHas) {
  KeyTable table;
  AddStreaming(table, 3);
  EXPECT_EQ(table.Add(Digest(1), 4, 2, kNow + kSecond * 12), 1U);
  EXPECT_EQ(table.connections(), 3U);
}

TEST(KeyTable, OneThatMovesCountsUnderItsNewKeyAlone) {
  KeyTable table;
  AddStreaming(table, 3);
  EXPECT_EQ(table.Move(1, Digest(2), 1), std::nullopt);
  EXPECT_EQ(table.keys(), 2U);
  EXPECT_EQ(table.Add(Digest(1), 4, 3, kNow), std::nullopt) << "its place there is free";
  EXPECT_EQ(table.Add(Digest(1), 5, 3, kNow), 4U) << "it is evicted no more, though the oldest";
  EXPECT_EQ(table.Move(2, Digest(2), 1), 1U) << "the newcomer stays";
  EXPECT_EQ(table.Move(2, Digest(2), 1), std::nullopt) << "it is there";
  EXPECT_EQ(table.Move(1, Digest(3), 1), std::nullopt) << "it was evicted";
  table.Remove(3);
  table.Remove(5);
  EXPECT_EQ(table.keys(), 1U);
}

TEST(KeyTable, ARemovedConnectionLeavesItsPlace) {
  KeyTable table;
  AddStreaming(table, 2);
  table.Remove(1);
  EXPECT_EQ(table.Add(Digest(1), 3, 2, kNow), std::nullopt);
}

TEST(KeyTable, AKeyIsForgottenWithItsLastConnection) {
  KeyTable table;
  AddStreaming(table, 2);
  table.Remove(1);
  EXPECT_EQ(table.keys(), 1U);
  table.Remove(2);
  EXPECT_EQ(table.keys(), 0U);
}

TEST(KeyTable, PassesOverAnEvictedConnection) {
  KeyTable table;
  AddStreaming(table, 1);
  ASSERT_EQ(table.Add(Digest(1), 2, 1, kNow), 1U);
  table.NoteHeard(1, kNow);
  table.SetStreams(1, 3);
  table.Remove(1);
  EXPECT_EQ(table.connections(), 1U);
}

TEST(KeyTable, HasWhatIsNeitherRemovedNorEvicted) {
  KeyTable table;
  AddStreaming(table, 2);
  EXPECT_TRUE(table.Has(1));
  ASSERT_EQ(table.Add(Digest(1), 3, 2, kNow), 1U);
  EXPECT_FALSE(table.Has(1));
  table.Remove(2);
  EXPECT_FALSE(table.Has(2));
  EXPECT_TRUE(table.Has(3));
}

constexpr std::uint64_t kThreads = 4;
constexpr std::uint64_t kConnectionsEach = 2'000;
constexpr std::size_t kPerKeyMax = 3;

/// What one of several threads does: connections of two keys come, stream and go.
void UseTable(KeyTable& table, std::uint64_t thread) {
  for (std::uint64_t i = 0; i < kConnectionsEach; ++i) {
    const std::uint64_t id = thread * kConnectionsEach + i;
    const auto evicted = table.Add(Digest(i % 2 == 0 ? 1 : 2), id, kPerKeyMax, kNow);
    if (evicted) table.Remove(*evicted);
    table.SetStreams(id, i % 3);
    table.NoteHeard(id, kNow + milliseconds(i));
    if (i % 5 == 0) table.Remove(id);
  }
}

TEST(KeyTable, ThreadsMayUseItAtOnce) {
  KeyTable table;
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&table, thread] { UseTable(table, thread); });
    }
  }
  EXPECT_LE(table.connections(), 2 * kPerKeyMax);
  for (std::uint64_t id = 0; id < kThreads * kConnectionsEach; ++id) table.Remove(id);
  EXPECT_EQ(table.keys(), 0U);
}

TEST(KeyTableDeathTest, AnIdThatIsTwiceInItIsOurBug) {
  KeyTable table;
  AddStreaming(table, 1);
  EXPECT_DEATH(static_cast<void>(table.Add(Digest(2), 1, 1, kNow)), "two connections");
}

}  // namespace
}  // namespace uplink::front
