#include "server/journal/presence_log.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

using model::Presence;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr Reconnected kSame = Reconnected::kSameServer;
constexpr Reconnected kReplaced = Reconnected::kMayHaveGoneBack;

storage::RobotRef RobotOf(const std::string& ruri) {
  return std::make_shared<const model::RobotId>(model::RobotId{ruri, "bench"});
}

std::vector<std::string> Lines(const std::vector<storage::PresenceItem>& items) {
  std::vector<std::string> lines;
  lines.reserve(items.size());
  for (const storage::PresenceItem& item : items) {
    lines.push_back(std::to_string(item.number) + " " + item.robot->ruri + " " +
                    std::string(ToText(item.presence)));
  }
  return lines;
}

class PresenceLogTest : public ::testing::Test {
 protected:
  PresenceLogTest() {
    for (const char* ruri : {"a", "b", "c", "d"}) log_.Hold(ruri, 1, std::nullopt);
  }
  void Note(const char* ruri, Presence presence) { log_.Note(RobotOf(ruri), presence, {}); }

  PresenceLog log_;
};

TEST_F(PresenceLogTest, NumbersWhatItHandsOver) {
  Note("b", Presence::kOnline);
  Note("a", Presence::kOffline);
  EXPECT_EQ(log_.size(), 2U);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("1 a offline", "2 b online"));
  EXPECT_TRUE(log_.empty());
  Note("b", Presence::kOffline);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("3 b offline"));
}

TEST_F(PresenceLogTest, HandsOverNoMoreThanItIsAskedFor) {
  for (const char* ruri : {"a", "b", "c"}) Note(ruri, Presence::kOnline);
  EXPECT_THAT(Lines(log_.Take(2)), ElementsAre("1 a online", "2 b online"));
  EXPECT_THAT(Lines(log_.Take(2)), ElementsAre("3 c online"));
  EXPECT_THAT(log_.Take(2), IsEmpty());
}

TEST_F(PresenceLogTest, TheLatestOfARobotIsEnough) {
  Note("a", Presence::kOnline);
  Note("a", Presence::kOffline);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("1 a offline"));
}

TEST_F(PresenceLogTest, AWayBackIsNoChange) {
  Note("a", Presence::kOnline);
  static_cast<void>(log_.Take(10));
  Note("a", Presence::kUnknown);
  Note("a", Presence::kOnline);
  EXPECT_TRUE(log_.empty());
}

TEST_F(PresenceLogTest, WhatAStoreThatWentBackLacksIsHandedOverAgain) {
  const SystemTime at = FromUnixMs(7);
  log_.Note(RobotOf("a"), Presence::kOnline, at);
  static_cast<void>(log_.Take(10));
  EXPECT_FALSE(
      log_.Follow(RobotOf("a"), storage::StoredPresence{Presence::kOnline, at}, kReplaced));
  EXPECT_TRUE(log_.empty());
  EXPECT_TRUE(
      log_.Follow(RobotOf("a"), storage::StoredPresence{Presence::kOffline, {}}, kReplaced));
  const auto items = log_.Take(10);
  EXPECT_THAT(Lines(items), ElementsAre("2 a online"));
  EXPECT_EQ(items.front().at, at);
  EXPECT_TRUE(log_.Follow(RobotOf("a"), std::nullopt, kReplaced));
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("3 a online"));
}

TEST_F(PresenceLogTest, WhatAStoreThatWentBackHasIsNoChange) {
  Note("a", Presence::kOffline);
  static_cast<void>(log_.Take(10));
  Note("a", Presence::kOnline);
  EXPECT_TRUE(log_.Follow(RobotOf("a"), storage::StoredPresence{Presence::kOnline, {}}, kReplaced));
  EXPECT_TRUE(log_.empty());
  EXPECT_EQ(log_.uncommitted(), 1U) << "the one that was taken";
}

TEST_F(PresenceLogTest, WhatWasPutBackIsWhatTheSameServerWillHave) {
  Note("a", Presence::kOnline);
  log_.PutBack(log_.Take(10));
  EXPECT_FALSE(log_.Follow(RobotOf("a"), std::nullopt, kSame));
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("1 a online"));
  EXPECT_TRUE(log_.empty());
}

TEST_F(PresenceLogTest, WhatWasPutBackAndAReplacedStoreLacksMayBeJudgedAnew) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kOnline, FromUnixMs(1)});
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(5));
  log_.PutBack(log_.Take(10));
  const storage::StoredPresence stored{Presence::kOnline, FromUnixMs(1)};
  EXPECT_FALSE(log_.Follow(RobotOf("a"), stored, kReplaced)) << "nothing that was told is lost";
  EXPECT_TRUE(log_.waits("a"));
  EXPECT_EQ(log_.uncommitted(), 1U);
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(6));
  EXPECT_FALSE(log_.waits("a"));
  EXPECT_EQ(log_.uncommitted(), 0U);
}

TEST_F(PresenceLogTest, WhatWasPutBackAndIsJudgedTheSameIsHandedOverWithItsTime) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kOnline, FromUnixMs(1)});
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(5));
  log_.PutBack(log_.Take(10));
  EXPECT_FALSE(log_.Follow(RobotOf("a"), std::nullopt, kReplaced));
  const auto items = log_.Take(10);
  EXPECT_THAT(Lines(items), ElementsAre("2 a offline"));
  EXPECT_EQ(items.front().at, FromUnixMs(5));
}

TEST_F(PresenceLogTest, WhatCameAfterThatWhichWasPutBackAndAReplacedStoreHasIsNoChange) {
  const storage::StoredPresence stored{Presence::kOnline, FromUnixMs(1)};
  log_.Hold("a", 2, stored);
  Note("a", Presence::kOffline);
  log_.PutBack(log_.Take(10));
  Note("a", Presence::kOnline);
  EXPECT_FALSE(log_.Follow(RobotOf("a"), stored, kReplaced));
  EXPECT_FALSE(log_.waits("a"));
  EXPECT_EQ(log_.uncommitted(), 0U);
}

TEST_F(PresenceLogTest, WhatCameAfterThatWhichWasPutBackGoesAlone) {
  Note("a", Presence::kOffline);
  log_.PutBack(log_.Take(10));
  Note("a", Presence::kOnline);
  EXPECT_FALSE(log_.Follow(RobotOf("a"), std::nullopt, kReplaced));
  EXPECT_EQ(log_.uncommitted(), 1U);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("2 a online"));
}

TEST_F(PresenceLogTest, WhatTheStoreHoldsIsNoChange) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kUnknown, {}});
  Note("a", Presence::kUnknown);
  EXPECT_TRUE(log_.empty());
  Note("a", Presence::kOnline);
  EXPECT_EQ(log_.size(), 1U);
}

TEST_F(PresenceLogTest, SaysUnderWhichHoldAChangeWas) {
  log_.Hold("a", 7, std::nullopt);
  Note("a", Presence::kOnline);
  EXPECT_EQ(log_.Take(1).front().held_since, 7U);
}

TEST_F(PresenceLogTest, AChangeOfARobotThatIsNotHeldIsDropped) {
  Note("x", Presence::kOffline);
  EXPECT_TRUE(log_.empty());
  EXPECT_EQ(log_.uncommitted(), 0U) << "nothing that a drain could wait for";
  log_.Hold("x", 3, storage::StoredPresence{Presence::kUnknown, {}});
  EXPECT_THAT(log_.Take(10), IsEmpty()) << "it may be of a stream that was here long before";
  Note("x", Presence::kOnline);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("1 x online"));
}

TEST_F(PresenceLogTest, NoChangeIsDatedBeforeTheOneBefore) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kUnknown, FromUnixMs(9)});
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(5));
  EXPECT_EQ(log_.Take(1).front().at, FromUnixMs(9)) << "or it would never be the latest";
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(8));
  EXPECT_EQ(log_.Take(1).front().at, FromUnixMs(9));
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(12));
  EXPECT_EQ(log_.Take(1).front().at, FromUnixMs(12));
}

TEST_F(PresenceLogTest, NothingIsLeftOfARobotThatWasLost) {
  Note("a", Presence::kOnline);
  Note("b", Presence::kOnline);
  log_.PutBack(log_.Take(10));
  Note("a", Presence::kOffline);
  EXPECT_EQ(log_.uncommitted(), 3U);
  log_.Lose("a");
  EXPECT_EQ(log_.uncommitted(), 1U);
  EXPECT_THAT(Lines(log_.Take(10)), ElementsAre("2 b online"));
  EXPECT_THAT(log_.Take(10), IsEmpty());
  log_.Hold("a", 9, std::nullopt);
  Note("a", Presence::kOnline);
  EXPECT_EQ(log_.size(), 1U) << "what was handed over of the former hold counts no more";
}

TEST_F(PresenceLogTest, AChangeIsUncommittedUntilItIsCommittedOrLeadsBack) {
  Note("a", Presence::kOnline);
  Note("a", Presence::kOffline);
  Note("b", Presence::kOnline);
  EXPECT_EQ(log_.uncommitted(), 2U);
  EXPECT_THAT(log_.Take(10), SizeIs(2));
  EXPECT_EQ(log_.uncommitted(), 2U) << "it was handed over, no more";
  log_.CountCommitted(2);
  EXPECT_EQ(log_.uncommitted(), 0U);
  Note("a", Presence::kOnline);
  EXPECT_EQ(log_.uncommitted(), 1U);
  Note("a", Presence::kOffline);
  EXPECT_EQ(log_.uncommitted(), 0U);
}

TEST_F(PresenceLogTest, WhatIsPutBackGoesAloneAndFirst) {
  for (const char* ruri : {"a", "b", "c", "d"}) Note(ruri, Presence::kOnline);
  std::vector<storage::PresenceItem> items = log_.Take(4);
  Note("a", Presence::kOffline);
  log_.PutBack({items.begin() + 2, items.end()});
  log_.PutBack({items.begin() + 1, items.begin() + 2});
  EXPECT_EQ(log_.size(), 1U) << "of what was never handed over";
  EXPECT_EQ(log_.uncommitted(), 5U);
  EXPECT_THAT(Lines(log_.Take(2)), ElementsAre("2 b online", "3 c online"));
  EXPECT_THAT(Lines(log_.Take(2)), ElementsAre("4 d online"));
  EXPECT_THAT(Lines(log_.Take(2)), ElementsAre("5 a offline"));
}

TEST_F(PresenceLogTest, DropsWhatWasPutBackIfTheStoreHasThatSinceAnEarlierTime) {
  const SystemTime first = FromUnixMs(1);
  const SystemTime last = FromUnixMs(3);
  log_.Note(RobotOf("a"), Presence::kOnline, last);
  log_.PutBack(log_.Take(10));
  // Its answer was lost.
  EXPECT_FALSE(
      log_.Follow(RobotOf("a"), storage::StoredPresence{Presence::kOnline, last}, kReplaced));
  EXPECT_TRUE(log_.waits("a"));
  // The store went back to before the robot was offline.
  EXPECT_TRUE(
      log_.Follow(RobotOf("a"), storage::StoredPresence{Presence::kOnline, first}, kReplaced));
  EXPECT_FALSE(log_.waits("a"));
  EXPECT_EQ(log_.uncommitted(), 0U);
  EXPECT_THAT(log_.Take(10), IsEmpty());
}

constexpr SystemTime kUntil = FromUnixMs(7'200'000);

TEST_F(PresenceLogTest, WhatIsParkedAloneChangesNoPresence) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kOnline, FromUnixMs(1)});
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(5), {}, kUntil);
  const auto items = log_.Take(10);
  ASSERT_THAT(items, SizeIs(1));
  EXPECT_FALSE(items[0].changes_presence);
  EXPECT_EQ(items[0].parked_until, kUntil);
  EXPECT_EQ(items[0].at, FromUnixMs(1)) << "online since then";
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(5), {}, kUntil);
  EXPECT_TRUE(log_.empty());
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(9), {}, kUntil);
  const auto offline = log_.Take(10);
  ASSERT_THAT(offline, SizeIs(1));
  EXPECT_TRUE(offline[0].changes_presence);
  EXPECT_EQ(offline[0].parked_until, kUntil);
}

TEST_F(PresenceLogTest, WhatIsParkedKeepsTheChangeThatWaits) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kOnline, FromUnixMs(1)});
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(5), model::ConnectionEnd::kOrderly);
  log_.Note(RobotOf("a"), Presence::kOffline, FromUnixMs(5), {}, kUntil);
  const auto items = log_.Take(10);
  ASSERT_THAT(items, SizeIs(1));
  EXPECT_TRUE(items[0].changes_presence);
  EXPECT_EQ(items[0].why, model::ConnectionEnd::kOrderly);
  EXPECT_EQ(items[0].parked_until, kUntil);
}

TEST_F(PresenceLogTest, ParkedAndBackBeforeACommitIsNoChange) {
  log_.Hold("a", 2, storage::StoredPresence{Presence::kOnline, FromUnixMs(1)});
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(1), {}, kUntil);
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(1));
  EXPECT_TRUE(log_.empty());
  EXPECT_EQ(log_.uncommitted(), 0U);
}

TEST_F(PresenceLogTest, ARobotThatWasNeverReportedIsParkedAsUnknown) {
  log_.Note(RobotOf("a"), Presence::kUnknown, FromUnixMs(1), {}, kUntil);
  const auto items = log_.Take(10);
  ASSERT_THAT(items, SizeIs(1));
  EXPECT_FALSE(items[0].changes_presence);
}

TEST_F(PresenceLogTest, AStoreThatLostAParkingGetsItAgain) {
  const storage::StoredPresence stored{Presence::kOnline, FromUnixMs(1)};
  log_.Hold("a", 2, stored);
  log_.Note(RobotOf("a"), Presence::kOnline, FromUnixMs(1), {}, kUntil);
  static_cast<void>(log_.Take(10));
  EXPECT_TRUE(log_.Follow(RobotOf("a"), stored, kReplaced));
  const auto items = log_.Take(10);
  ASSERT_THAT(items, SizeIs(1));
  EXPECT_EQ(items[0].parked_until, kUntil);
}

}  // namespace
}  // namespace uplink::journal
