// One fleet's shared set and its receivers: snapshot, changes, and how they are counted.
#include "server/forward/fleet_items.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/forward/receiving.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

class FleetItemsTest : public ::testing::Test {
 protected:
  ~FleetItemsTest() override { ExpectBalanced(); }

  void ExpectBalanced() const {
    const FleetItems::Sum sum = fleet_.sum();
    const Counts& counts = sum.counts;
    EXPECT_EQ(counts.due,
              counts.written + counts.coalesced + counts.replaced + counts.dropped + sum.waiting);
  }
  void Put(const ItemKey& key, std::string_view text, std::int64_t expires_ms = 0) {
    const auto out = fleet_.Put(key, {Text(text), expires_ms});
    for (const loop::StreamRef stream : out.to_wake) stream.Wake();
    told_ = out.receivers;
  }
  void Remove(const ItemKey& key, std::string_view text) {
    for (const loop::StreamRef stream : fleet_.Remove(key, Text(text)).to_wake) stream.Wake();
  }
  std::unique_ptr<FleetItems::Receiver> Join(std::string_view robot, std::uint64_t stream = 1) {
    return fleet_.Join(std::string(robot), {&woken_, stream});
  }
  std::vector<std::string> Take(FleetItems::Receiver& receiver) {
    std::vector<EncodedFrame> frames;
    fleet_.Take(receiver, frames);
    ExpectBalanced();
    return Texts(frames);
  }
  /// All that is due, however many turns it takes.
  std::vector<std::string> TakeAll(FleetItems::Receiver& receiver) {
    std::vector<std::string> all;
    for (auto some = Take(receiver); !some.empty(); some = Take(receiver)) {
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }

  Woken woken_;
  /// Receivers for which the last item that was put waits.
  std::size_t told_ = 0;
  FleetItems fleet_{{Text("begin"), Text("end")}, true};
};

TEST_F(FleetItemsTest, ASnapshotHoldsWhatTheOthersShare) {
  Put(KeyOf("a", "1"), "a1");
  Put(KeyOf("b", "1"), "b1");
  const auto a = Join("a");
  const auto c = Join("c", 2);
  EXPECT_THAT(TakeAll(*a), ElementsAre("begin", "b1", "end"));
  EXPECT_THAT(TakeAll(*c), ElementsAre("begin", "a1", "b1", "end"));
  fleet_.Leave(*a);
  fleet_.Leave(*c);
}

TEST_F(FleetItemsTest, ASnapshotOfNothingSaysSo) {
  const auto a = Join("a");
  EXPECT_THAT(TakeAll(*a), ElementsAre("begin", "end"));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, NothingBeginsBeforeTheSetIsWhole) {
  FleetItems unread({Text("begin"), Text("end")}, false);
  const auto a = unread.Join("a", {&woken_, 7});
  std::vector<EncodedFrame> frames;
  unread.Take(*a, frames);
  EXPECT_THAT(frames, IsEmpty());
  EXPECT_THAT(unread.Put(KeyOf("b", "1"), {Text("b1")}).to_wake, IsEmpty());
  unread.Take(*a, frames);
  EXPECT_THAT(frames, IsEmpty());
  EXPECT_THAT(unread.SetWhole(), ElementsAre(loop::StreamRef{&woken_, 7}));
  EXPECT_THAT(unread.SetWhole(), IsEmpty()) << "it was so before";
  unread.Take(*a, frames);
  EXPECT_THAT(Texts(frames), ElementsAre("begin", "b1", "end"));
  unread.Leave(*a);
}

TEST_F(FleetItemsTest, AChangeGoesToAllButItsOrigin) {
  const auto a = Join("a", 1);
  const auto b = Join("b", 2);
  const auto c = Join("c", 3);
  for (const auto* receiver : {&a, &b, &c}) static_cast<void>(TakeAll(**receiver));
  Put(KeyOf("b", "1"), "b1");
  EXPECT_THAT(woken_.Take(), ElementsAre(1, 3));
  EXPECT_THAT(TakeAll(*a), ElementsAre("b1"));
  EXPECT_THAT(TakeAll(*b), IsEmpty());
  EXPECT_THAT(TakeAll(*c), ElementsAre("b1"));
  EXPECT_EQ(fleet_.sum().counts.due, 2U);
  EXPECT_EQ(fleet_.sum().counts.written, 2U);
  for (const auto* receiver : {&a, &b, &c}) fleet_.Leave(**receiver);
}

TEST_F(FleetItemsTest, ARemovalIsToldAndWhatIsNotThereIsNotRemoved) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "1"), "b1");
  static_cast<void>(TakeAll(*a));
  Remove(KeyOf("b", "2"), "gone b2");
  EXPECT_THAT(TakeAll(*a), IsEmpty());
  Remove(KeyOf("b", "1"), "gone b1");
  EXPECT_THAT(TakeAll(*a), ElementsAre("gone b1"));
  EXPECT_EQ(fleet_.FrameOf(KeyOf("b", "1")), nullptr);
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, AStreamThatWasWokenIsNotWokenAgainUntilItLooked) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "1"), "b1");
  Put(KeyOf("b", "2"), "b2");
  EXPECT_THAT(woken_.Take(), ElementsAre(1));
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "3"), "b3");
  EXPECT_THAT(woken_.Take(), ElementsAre(1));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, OfAnItemTheLatestWaits) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "1"), "first");
  Put(KeyOf("b", "2"), "other");
  Put(KeyOf("b", "1"), "second");
  EXPECT_THAT(TakeAll(*a), ElementsAre("second", "other"));
  Put(KeyOf("b", "2"), "other again");
  Put(KeyOf("b", "1"), "again");
  Remove(KeyOf("b", "2"), "gone");
  Put(KeyOf("b", "2"), "third");
  EXPECT_THAT(TakeAll(*a), ElementsAre("third", "again"));
  EXPECT_EQ(fleet_.sum().counts.coalesced, 3U);
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, SaysForHowManyAChangeWaitsThatWasNotToldBefore) {
  Put(KeyOf("b", "1"), "no receiver yet");
  EXPECT_EQ(told_, 0U);
  const auto a = Join("a", 1);
  const auto b = Join("b", 2);
  const auto c = Join("c", 3);
  Put(KeyOf("b", "1"), "their snapshot will hold it");
  EXPECT_EQ(told_, 0U);
  for (const auto* receiver : {&a, &b, &c}) static_cast<void>(TakeAll(**receiver));
  Put(KeyOf("b", "1"), "new for a and c");
  EXPECT_EQ(told_, 2U);
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "1"), "c has not looked");
  EXPECT_EQ(told_, 1U);
  for (const auto* receiver : {&a, &b, &c}) fleet_.Leave(**receiver);
}

TEST_F(FleetItemsTest, OfAnItemThatCameAndWentMeanwhileNothingIsTold) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  Put(KeyOf("b", "1"), "comes");
  Put(KeyOf("b", "1"), "changes");
  Remove(KeyOf("b", "1"), "gone");
  EXPECT_THAT(TakeAll(*a), IsEmpty());
  EXPECT_EQ(fleet_.sum().counts.due, 3U);
  EXPECT_EQ(fleet_.sum().counts.coalesced, 3U);
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, PastTheBoundANewSnapshotComes) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  for (std::size_t i = 0; i < kWaitingMax; ++i) Put(KeyOf("b", std::to_string(i)), "x");
  EXPECT_EQ(fleet_.sum().waiting, kWaitingMax);
  Put(KeyOf("b", "more"), "x");
  EXPECT_EQ(fleet_.sum().waiting, 0U);
  EXPECT_EQ(fleet_.sum().counts.replaced, kWaitingMax + 1);
  Remove(KeyOf("b", "0"), "gone");
  const auto all = TakeAll(*a);
  EXPECT_THAT(all, SizeIs(1 + kWaitingMax + 1)) << "the marks, and what is there";
  EXPECT_EQ(all.front(), "begin");
  EXPECT_EQ(all.back(), "end");
  EXPECT_EQ(fleet_.sum().counts.snapshots, 2U);
  EXPECT_EQ(fleet_.sum().counts.overflows, 1U);
  EXPECT_THAT(fleet_.TakeOverflowed(), ElementsAre(Pair("a", "b")));
  EXPECT_THAT(fleet_.TakeOverflowed(), IsEmpty()) << "it was named";
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, WhatChangesWhileASnapshotIsWalkedComesOnce) {
  // Three digits, so that they sort by their number.
  const auto name = [](std::size_t i) { return std::to_string(100 + i); };
  for (std::size_t i = 0; i < 3 * kTakenMax; ++i) Put(KeyOf("b", name(i)), "old " + name(i));
  const auto a = Join("a");
  auto all = Take(*a);
  ASSERT_THAT(all, SizeIs(1 + kTakenMax));
  EXPECT_EQ(fleet_.sum().snapshots_open, 1U);
  EXPECT_EQ(all.back(), "old " + name(kTakenMax - 1));
  Put(KeyOf("b", name(0)), "new 0");
  Put(KeyOf("b", name(kTakenMax - 1)), "new at the edge");
  Put(KeyOf("b", name(kTakenMax)), "new behind");
  Remove(KeyOf("b", name(1)), "gone 1");
  Remove(KeyOf("b", name(2 * kTakenMax)), "never seen");
  EXPECT_EQ(fleet_.sum().waiting, 3U);
  EXPECT_EQ(fleet_.sum().counts.replaced, 2U);
  const auto rest = TakeAll(*a);
  ASSERT_THAT(rest, SizeIs(2 * kTakenMax - 1 + 1 + 3));
  EXPECT_EQ(fleet_.sum().snapshots_open, 0U);
  EXPECT_THAT(std::vector(rest.begin(), rest.begin() + 3),
              ElementsAre("new 0", "new at the edge", "new behind"));
  EXPECT_THAT(std::vector(rest.end() - 2, rest.end()), ElementsAre("end", "gone 1"))
      << "a snapshot holds no ends";
  EXPECT_THAT(rest, ::testing::Not(::testing::Contains("never seen")));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, ASnapshotGoesOnHoweverMuchChangesBehindIt) {
  constexpr std::size_t kItems = 8 * kTakenMax;
  const auto name = [](std::size_t i) { return std::to_string(1000 + i); };
  for (std::size_t i = 0; i < kItems; ++i) Put(KeyOf("b", name(i)), "old");
  const auto a = Join("a");
  std::vector<std::string> all;
  std::size_t takes = 0;
  for (auto some = Take(*a); std::ranges::find(some, "end") == some.end(); some = Take(*a)) {
    ASSERT_LE(++takes, 2 * kItems / kTakenMax) << "half of each piece is the walk's";
    EXPECT_LE(some.size(), 1 + kTakenMax);
    // All that was passed changes again.
    for (std::size_t i = 0; i < kItems; ++i) Put(KeyOf("b", name(i)), "new");
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_GT(std::ranges::count(all, "new"), 0);
  EXPECT_EQ(std::ranges::count(all, "begin"), 1);
  EXPECT_EQ(fleet_.sum().counts.overflows, 0U);
  static_cast<void>(TakeAll(*a));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, ASlowReceiverNeedsNoSecondSnapshotForChangesThatItKeepsUpWith) {
  // As many as wait at most, and as many again: what changes behind the walk would not fit.
  constexpr std::size_t kItems = 2 * kWaitingMax;
  const auto name = [](std::size_t i) { return std::to_string(10'000 + i); };
  for (std::size_t i = 0; i < kItems; ++i) Put(KeyOf("b", name(i)), "old");
  const auto a = Join("a");
  std::size_t changed = 0;
  auto some = Take(*a);
  for (; std::ranges::find(some, "end") == some.end(); some = Take(*a)) {
    for (std::size_t i = 0; i < kTakenMax / 2; ++i) Put(KeyOf("b", name(changed++)), "new");
  }
  EXPECT_GT(changed, kWaitingMax);
  EXPECT_EQ(fleet_.sum().counts.overflows, 0U);
  EXPECT_EQ(fleet_.sum().counts.snapshots, 1U);
  static_cast<void>(TakeAll(*a));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, ATooLongTableWithinASnapshotBringsAnotherOneAfterIt) {
  Put(KeyOf("a", "first"), "a");
  for (std::size_t i = 0; i < 2 * kTakenMax; ++i) Put(KeyOf("y", std::to_string(i)), "y");
  const auto z = Join("z");
  static_cast<void>(Take(*z));
  for (std::size_t i = 0; i <= kWaitingMax; ++i) Put(KeyOf("a", std::to_string(i)), "late");
  EXPECT_EQ(fleet_.sum().waiting, 0U);
  const auto rest = TakeAll(*z);
  EXPECT_EQ(std::ranges::count(rest, "begin"), 1);
  EXPECT_EQ(std::ranges::count(rest, "end"), 2);
  EXPECT_EQ(std::ranges::count(rest, "late"), kWaitingMax + 1);
  EXPECT_EQ(rest.back(), "end");
  fleet_.Leave(*z);
}

TEST_F(FleetItemsTest, ATakeEndsAtItsFramesAndAtItsBytes) {
  const auto a = Join("a");
  static_cast<void>(TakeAll(*a));
  for (std::size_t i = 0; i <= kTakenMax; ++i) Put(KeyOf("b", std::to_string(i)), "x");
  EXPECT_THAT(Take(*a), SizeIs(kTakenMax));
  EXPECT_THAT(Take(*a), SizeIs(1));
  const std::string large(kTakenBytesMax - 1, 'x');
  for (const char* id : {"1", "2", "3"}) Put(KeyOf("b", id), large);
  EXPECT_THAT(Take(*a), SizeIs(2)) << "the last may reach beyond";
  EXPECT_THAT(Take(*a), SizeIs(1));
  fleet_.Leave(*a);
}

TEST_F(FleetItemsTest, TheLimitsOfReceiversAreGiven) {
  FleetItems small({Text("begin"), Text("end")}, true,
                   {.waiting_max = 3, .taken_max = 2, .taken_bytes_max = kTakenBytesMax});
  const auto a = small.Join("a", {&woken_, 1});
  std::vector<EncodedFrame> frames;
  small.Take(*a, frames);
  for (const char* id : {"1", "2", "3"}) small.Put(KeyOf("b", id), {Text(id)});
  EXPECT_EQ(small.sum().waiting, 3U);
  frames.clear();
  small.Take(*a, frames);
  EXPECT_THAT(Texts(frames), ElementsAre("1", "2"));
  for (const char* id : {"4", "5", "6"}) small.Put(KeyOf("b", id), {Text(id)});
  EXPECT_EQ(small.sum().waiting, 0U) << "a snapshot is to come";
  frames.clear();
  small.Take(*a, frames);
  EXPECT_THAT(Texts(frames), ElementsAre("begin", "1", "2"));
  small.Leave(*a);
}

TEST_F(FleetItemsTest, WhatWaitsForAStreamThatEndsIsDropped) {
  const auto a = Join("a", 1);
  const auto b = Join("b", 2);
  const auto c = Join("c", 3);
  for (const auto* receiver : {&a, &b, &c}) static_cast<void>(TakeAll(**receiver));
  Put(KeyOf("d", "1"), "x");
  fleet_.Leave(*a);
  ExpectBalanced();
  EXPECT_EQ(fleet_.sum().counts.dropped, 1U);
  EXPECT_EQ(fleet_.sum().receivers, 2U);
  EXPECT_THAT(TakeAll(*c), ElementsAre("x")) << "it has another place now";
  fleet_.Leave(*c);
  EXPECT_THAT(TakeAll(*b), ElementsAre("x"));
  fleet_.Leave(*b);
}

TEST_F(FleetItemsTest, WhatExpiresIsNamedInTime) {
  Put(KeyOf("a", "1"), "x", 1000);
  Put(KeyOf("a", "2"), "x", 1000);
  Put(KeyOf("a", "3"), "x", 2000);
  Put(KeyOf("a", "never"), "x");
  EXPECT_THAT(fleet_.Expired(999, 10), IsEmpty());
  EXPECT_THAT(fleet_.Expired(1000, 10), ElementsAre(KeyOf("a", "1"), KeyOf("a", "2")));
  EXPECT_THAT(fleet_.Expired(1000, 1), ElementsAre(KeyOf("a", "1")));
  fleet_.SetExpiry(KeyOf("a", "1"), 3000);
  Remove(KeyOf("a", "2"), "gone");
  EXPECT_THAT(fleet_.Expired(2000, 10), ElementsAre(KeyOf("a", "3")));
}

}  // namespace
}  // namespace uplink::forward
