// How the shared set follows the store: read whole once, then by its changes.
#include "server/forward/rounds.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/unit/server/forward/rounds_bench.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

TEST(LookAgainAfter, GrowsWithTheStreamsThatWereWoken) {
  EXPECT_EQ(LookAgainAfter(0), std::chrono::milliseconds(10));
  EXPECT_EQ(LookAgainAfter(200), std::chrono::milliseconds(10));
  EXPECT_EQ(LookAgainAfter(202), std::chrono::microseconds(10'100));
  EXPECT_EQ(LookAgainAfter(2000), std::chrono::milliseconds(100));
  EXPECT_EQ(LookAgainAfter(5000), std::chrono::milliseconds(250));
  EXPECT_EQ(LookAgainAfter(1'000'000), std::chrono::milliseconds(250));
}

/// Large, but small enough that a robot may share several.
std::string LargeGeometry() {
  std::string points = "[1.5,2.5]";
  while (points.size() < 2'000'000) points += ",[1.5,2.5]";
  return R"({"type":"LineString","coordinates":[)" + points + "]}";
}

TEST_F(RoundsTest, ReadsAllPagesThenSaysThatItIsWhole) {
  for (const char* id : {"1", "2", "3", "4", "5"}) items_.Set(KeyOf("a", id));
  EXPECT_FALSE(forwards_.sum().whole);
  Round();
  EXPECT_THAT(Ids(), ElementsAre("1", "2", "3", "4", "5"));
  EXPECT_TRUE(forwards_.sum().whole);
  EXPECT_EQ(probe_.reads_of_all.value(), 1);
  Round();
  EXPECT_EQ(probe_.reads_of_all.value(), 1);
}

TEST_F(RoundsTest, IsNotWholeWhileAPageIsMissing) {
  for (const char* id : {"1", "2", "3"}) items_.Set(KeyOf("a", id));
  items_.fails_at_page = 1;
  Round();
  EXPECT_FALSE(forwards_.sum().whole);
  EXPECT_EQ(probe_.failing.value(), 1);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_fails why=\"away within the read\"")));
  Round();
  EXPECT_TRUE(forwards_.sum().whole);
  EXPECT_THAT(Ids(), ElementsAre("1", "2", "3"));
  EXPECT_EQ(probe_.failing.value(), 0);
  EXPECT_THAT(lines_.back(), HasSubstr("forward_works_again"));
}

TEST_F(RoundsTest, FollowsEveryChangeHoweverMany) {
  Round();
  for (const char* id : {"1", "2", "3", "4", "5"}) items_.Set(KeyOf("a", id));
  items_.Erase(KeyOf("a", "2"));
  Round();
  EXPECT_THAT(Ids(), ElementsAre("1", "3", "4", "5"));
  EXPECT_EQ(items_.asked_for_positions, 1);
}

TEST_F(RoundsTest, WhatWasTrimmedIsReadAnew) {
  items_.Set(KeyOf("a", "1"));
  items_.Set(KeyOf("a", "2"));
  Round();
  items_.Erase(KeyOf("a", "1"));
  items_.Set(KeyOf("a", "3"));
  items_.trimmed_to = items_.log.size();
  Round();
  EXPECT_THAT(Ids(), ElementsAre("2", "3")) << "what went meanwhile is gone here too";
  EXPECT_EQ(probe_.reads_of_all.value(), 2);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_changes_missed")));
}

TEST_F(RoundsTest, AStoreThatIsAwayIsAskedAgainFromWhereItWas) {
  Round();
  items_.Set(KeyOf("a", "1"));
  items_.status = absl::UnavailableError("away");
  Round();
  Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_fails")));
  EXPECT_THAT(Ids(), IsEmpty());
  items_.status = absl::OkStatus();
  Round();
  EXPECT_THAT(Ids(), ElementsAre("1"));
}

TEST_F(RoundsTest, WhatExpiredGoesByAClockThatIsVouchedFor) {
  const std::int64_t now = UnixMs(clock_.System());
  items_.Set(KeyOf("a", "gone"), now);
  items_.Set(KeyOf("a", "soon"), now + 1000);
  items_.Set(KeyOf("a", "never"));
  Round();
  EXPECT_THAT(Ids(), ElementsAre("never", "soon"));
  trust_.Set(false);
  clock_.Advance(milliseconds(1000));
  Round();
  EXPECT_THAT(Ids(), ElementsAre("never", "soon")) << "the time is not vouched for";
  trust_.Set(true);
  Round();
  EXPECT_THAT(Ids(), ElementsAre("never"));
}

TEST_F(RoundsTest, ReceiversAreWokenByEachLookWhateverTheStoreAnswers) {
  Woken woken;
  const auto receiver = forwards_.Join({.ruri = "b", .fleet = "north"}, {&woken, 7});
  items_.Set(KeyOf("a", "soon"), UnixMs(clock_.System()) + 1000);
  Round();
  EXPECT_THAT(woken.Take(), ElementsAre(7)) << "the set is whole";
  std::vector<EncodedFrame> frames;
  receiver->Take(frames);
  items_.Set(KeyOf("a", "new"));
  Round();
  EXPECT_THAT(woken.Take(), ElementsAre(7)) << "by a change";
  receiver->Take(frames);
  clock_.Advance(milliseconds(1000));
  items_.status = absl::UnavailableError("away");
  Round();
  EXPECT_THAT(woken.Take(), ElementsAre(7)) << "by an end that needs no store";
}

TEST_F(RoundsTest, WhatCannotBeReadIsCountedAndNamed) {
  items_.Set(KeyOf("a", "bad"), 0, "no geometry");
  items_.Set(KeyOf("a", "good"));
  Round();
  EXPECT_THAT(Ids(), ElementsAre("good"));
  EXPECT_EQ(probe_.unreadable.value(), 1);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_unreadable robot=a id=bad")));
}

TEST_F(RoundsTest, WhatWasLeftOutIsReadAgainOnceItsRobotHasRoom) {
  const std::string large = LargeGeometry();
  for (std::size_t i = 0; i < 10; ++i) items_.Set(KeyOf("a", std::to_string(i)), 0, large);
  items_.Set(KeyOf("b", "small"));
  Round();
  EXPECT_LT(Ids().size(), 11U);
  EXPECT_TRUE(forwards_.left_out());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_left_out robot=a")));
  const std::size_t pages = items_.pages;
  clock_.Advance(kLookAtLeftOutEvery);
  Round();
  EXPECT_EQ(items_.pages, pages) << "there is no room yet";
  for (std::size_t i = 1; i < 10; ++i) items_.Erase(KeyOf("a", std::to_string(i)));
  items_.Set(KeyOf("c", "other"));
  Round();
  EXPECT_TRUE(forwards_.left_out()) << "not before its time";
  clock_.Advance(kLookAtLeftOutEvery);
  Round();
  EXPECT_FALSE(forwards_.left_out());
  EXPECT_THAT(Ids(), UnorderedElementsAre("0", "small", "other"));
  EXPECT_THAT(lines_.back(), HasSubstr("forward_complete_again"));
  EXPECT_EQ(probe_.reads_of_all.value(), 1) << "one robot costs no look at all others";
}

TEST_F(RoundsTest, ALookAtWhatWasLeftOutThatFailsIsRepeated) {
  const std::string large = LargeGeometry();
  for (std::size_t i = 0; i < 10; ++i) items_.Set(KeyOf("a", std::to_string(i)), 0, large);
  Round();
  const std::vector<std::string> held = Ids();
  ASSERT_TRUE(forwards_.left_out());
  for (const std::string& id : held) items_.Erase(KeyOf("a", id));
  Round();
  clock_.Advance(kLookAtLeftOutEvery);
  items_.fails_at_page = items_.pages;
  Round();
  EXPECT_THAT(Ids(), IsEmpty());
  EXPECT_TRUE(forwards_.left_out()) << "it is not there yet";
  clock_.Advance(kLookAtLeftOutEvery);
  Round();
  EXPECT_THAT(Ids(), SizeIs(10 - held.size()));
  EXPECT_FALSE(forwards_.left_out());
}

TEST_F(RoundsTest, WhatWasLeftOutAndHasGoneOrShrunkIsMissedNoMore) {
  const std::string large = LargeGeometry();
  for (std::size_t i = 0; i < 10; ++i) items_.Set(KeyOf("a", std::to_string(i)), 0, large);
  Round();
  const std::vector<std::string> held = Ids();
  ASSERT_LT(held.size(), 9U);
  // Of those that had no room one becomes small, and the others go: nothing gives room back.
  items_.Set(KeyOf("a", std::to_string(held.size())));
  for (std::size_t i = held.size() + 1; i < 10; ++i) items_.Erase(KeyOf("a", std::to_string(i)));
  clock_.Advance(kLookAtLeftOutEvery);
  Round();
  EXPECT_THAT(Ids(), SizeIs(held.size() + 1));
  EXPECT_FALSE(forwards_.left_out());
  EXPECT_THAT(lines_.back(), HasSubstr("forward_complete_again"));
}

TEST_F(RoundsTest, ARobotThatGoesOnGivingRoomBackIsReadOnceInALook) {
  const std::string large = LargeGeometry();
  for (std::size_t i = 0; i < 20; ++i) items_.Set(KeyOf("a", std::to_string(i)), 0, large);
  Round();
  ASSERT_TRUE(forwards_.left_out());
  items_.at_each_page = [&, number = 100]() mutable {
    items_.Erase(KeyOf("a", Ids().front()));
    items_.Set(KeyOf("a", std::to_string(number++)), 0, large);
  };
  items_.at_each_page();
  clock_.Advance(kLookAtLeftOutEvery);
  const std::size_t before = items_.pages;
  Round();
  EXPECT_LE(items_.pages, before + 2 * 11) << "its pages of shapes, and of objects";
  EXPECT_TRUE(forwards_.left_out());
}

TEST_F(RoundsTest, AReceiverThatFallsBehindIsNamed) {
  Woken woken;
  const auto receiver = forwards_.Join({.ruri = "slow", .fleet = "north"}, {&woken, 7});
  Round();
  std::vector<EncodedFrame> frames;
  receiver->Take(frames);
  for (std::size_t i = 0; i <= kWaitingMax; ++i) items_.Set(KeyOf("a", std::to_string(i)));
  Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_receiver_behind robot=slow most_from=a")));
  EXPECT_EQ(forwards_.sum().counts.overflows, 1U);
}

TEST_F(RoundsTest, EndsDoNotWaitForALookAtWhatWasLeftOut) {
  const std::string large = LargeGeometry();
  for (std::size_t i = 0; i < 20; ++i) items_.Set(KeyOf("a", std::to_string(i)), 0, large);
  items_.Set(KeyOf("b", "short-lived"), UnixMs(clock_.System()) + 100'000);
  Round();
  ASSERT_TRUE(forwards_.left_out());
  items_.Erase(KeyOf("a", Ids().front()));
  clock_.Advance(kLookAtLeftOutEvery);
  std::size_t pages = 0;
  std::vector<std::string> at_last_page;
  items_.at_each_page = [&] {
    if (++pages == 2) clock_.Advance(std::chrono::seconds(50));
    at_last_page = Ids();
  };
  Round();
  EXPECT_GT(pages, 3U);
  EXPECT_THAT(at_last_page, ::testing::Not(::testing::Contains("short-lived")));
}

TEST_F(RoundsTest, NothingIsTakenForExpiredByAClockThatNobodyVouchesFor) {
  trust_.Set(false);
  items_.Set(KeyOf("a", "perhaps"), UnixMs(clock_.System()));
  Round();
  EXPECT_THAT(Ids(), ElementsAre("perhaps"));
}

TEST_F(RoundsTest, EachItemThatCannotBeReadIsToldOnceAndUntilItEnds) {
  for (const char* id : {"1", "2"}) items_.Set(KeyOf("a", id), 0, "no geometry");
  Round();
  items_.Set(KeyOf("a", "1"), 0, "none again");
  Round();
  EXPECT_EQ(probe_.unreadable_now.value(), 2);
  EXPECT_THAT(lines_, SizeIs(2));
  items_.Set(KeyOf("a", "1"));
  items_.Erase(KeyOf("a", "2"));
  Round();
  EXPECT_EQ(probe_.unreadable_now.value(), 0);
  EXPECT_THAT(Ids(), ElementsAre("1"));
}

TEST_F(RoundsTest, HowFarItFollowedIsKnown) {
  Round();
  EXPECT_EQ(probe_.followed_at_ms.value(), SteadyMs(clock_.Steady()));
  clock_.Advance(milliseconds(500));
  items_.status = absl::UnavailableError("away");
  Round();
  EXPECT_EQ(probe_.followed_at_ms.value(), SteadyMs(clock_.Steady()) - 500);
}

TEST_F(RoundsTest, MoreChangesThanAreLookedUpAtOnceAreLookedUpInParts) {
  Round();
  constexpr std::size_t kChanges = 2 * kLookedUpMax + 1;
  items_.changes_at_once = kChanges;
  for (std::size_t i = 0; i < kChanges; ++i) items_.Set(KeyOf("a", std::to_string(i)));
  Round();
  EXPECT_THAT(Ids(), SizeIs(kChanges));
  EXPECT_THAT(items_.looked_up, ElementsAre(kLookedUpMax, kLookedUpMax, 1));
  items_.looked_up.clear();
  for (std::size_t i = 0; i < kLookedUpMax; ++i) items_.Erase(KeyOf("a", std::to_string(i)));
  Round();
  EXPECT_THAT(items_.looked_up, ElementsAre(kLookedUpMax)) << "as many as it may be are one";
  EXPECT_THAT(Ids(), SizeIs(kChanges - kLookedUpMax));
}

/// Rounds on a thread of its own, by real time.
class RoundsThreadTest : public ::testing::Test {
 protected:
  Rounds::Context Context(SteadyTime::duration look_every) {
    return {.clock = clock_,
            .logger = logger_,
            .items = items_,
            .forwards = forwards_,
            .probe = probe_,
            .clock_trust = trust_,
            .look_every = look_every};
  }
  /// So many looks were begun in all.
  bool Looked(std::size_t looks) {
    return testing::Eventually([&] { return items_.looks().size() >= looks; });
  }

  SystemClock clock_;
  testing::FakeTrust trust_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  LockedItems items_;
  Forwards forwards_{{kSharedBytesMax, kFleetBytesMax, kRobotBytesMax}, std::mt19937_64(1)};
  ForwardProbe probe_;
};

TEST_F(RoundsThreadTest, LooksWhenItIsWoken) {
  // Nothing else would make it look.
  Rounds rounds(Context(std::chrono::hours(1)));
  rounds.Start();
  ASSERT_TRUE(Looked(1));
  for (std::size_t looks = 2; looks < 5; ++looks) {
    items_.With([&](ScriptedItems& items) { items.Set(KeyOf("a", std::to_string(looks))); });
    rounds.Wake();
    ASSERT_TRUE(Looked(looks));
  }
  EXPECT_TRUE(testing::Eventually([&] { return forwards_.sum().items == 3; }));
  rounds.Stop();
}

TEST_F(RoundsThreadTest, LooksAgainWithinTwoSecondsThoughNothingWakesIt) {
  Rounds rounds(Context(kLookEvery));
  rounds.Start();
  // A machine under load may keep one of them waiting, not all.
  const bool in_time = testing::Eventually([&] {
    const std::vector<SteadyTime> looks = items_.looks();
    for (std::size_t i = 1; i < looks.size(); ++i) {
      if (looks[i] - looks[i - 1] < std::chrono::seconds(2)) return true;
    }
    return false;
  });
  rounds.Stop();
  EXPECT_TRUE(in_time);
}

}  // namespace
}  // namespace uplink::forward
