// What a reader of changes missed, and what it may go on from.
#include "storage/change_walk.h"

#include <chrono>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr WriterId kA = {1};
constexpr WriterId kB = {2};
constexpr SystemTime kNow = SystemTime(hours(1'000'000));

ItemKey Key(const std::string& id) { return {PresentKind::kShape, "rcan://r", id}; }

class ChangeWalkTest : public ::testing::Test {
 protected:
  /// A reader that read this much, and a store whose last changes are these.
  [[nodiscard]] ChangeWalk Walk() const { return {from_, last_}; }

  ChangePositions from_{.writers = {{kA, {5, kNow}}}, .read_at = kNow};
  ChangePositions last_{.writers = {{kA, {7, kNow}}}, .read_at = kNow + seconds(1)};
};

TEST_F(ChangeWalkTest, NamesEachItemOnceInTheOrderOfItsFirstChange) {
  last_.writers[kA] = {8, kNow};
  ChangeWalk walk = Walk();
  walk.Take(kA, {6, kNow}, Key("x"));
  walk.Take(kA, {7, kNow}, Key("y"));
  walk.Take(kA, {8, kNow}, Key("x"));
  const SharedChanges changes = std::move(walk).Finish();
  EXPECT_FALSE(changes.trimmed);
  EXPECT_FALSE(changes.more);
  EXPECT_THAT(changes.keys, ElementsAre(Key("x"), Key("y")));
  EXPECT_EQ(changes.positions.writers.at(kA).number, 8U);
  EXPECT_EQ(changes.positions.read_at, last_.read_at);
}

TEST_F(ChangeWalkTest, AWriterThatIsNewIsReadFromItsFirstChange) {
  last_.writers = {{kA, {5, kNow}}, {kB, {1, kNow}}};
  ChangeWalk walk = Walk();
  walk.Take(kB, {1, kNow}, Key("x"));
  const SharedChanges changes = std::move(walk).Finish();
  EXPECT_FALSE(changes.trimmed);
  EXPECT_EQ(changes.positions.writers.at(kB).number, 1U);
  EXPECT_EQ(changes.positions.writers.at(kA).number, 5U);
}

TEST_F(ChangeWalkTest, AHoleMeansThatSomethingWasMissed) {
  ChangeWalk walk = Walk();
  walk.Take(kA, {7, kNow}, Key("x"));
  const SharedChanges changes = std::move(walk).Finish();
  EXPECT_TRUE(changes.trimmed);
  EXPECT_THAT(changes.keys, IsEmpty());
}

TEST_F(ChangeWalkTest, AWriterOfWhichNothingIsLeftMeansTheSame) {
  EXPECT_TRUE(std::move(Walk()).Finish().trimmed) << "7 was written, and cannot be read";
}

TEST_F(ChangeWalkTest, AFullAnswerSaysThatMoreMayBeThere) {
  last_.writers[kA] = {5 + kChangesReadMax + 1, kNow};
  ChangeWalk walk = Walk();
  for (std::size_t i = 1; i < kChangesReadMax; ++i) walk.Take(kA, {5 + i, kNow}, Key("x"));
  ChangeWalk full = walk;
  full.Take(kA, {5 + kChangesReadMax, kNow}, Key("y"));
  const SharedChanges changes = std::move(full).Finish();
  EXPECT_TRUE(changes.more);
  EXPECT_FALSE(changes.trimmed);
  EXPECT_THAT(changes.keys, ElementsAre(Key("x"), Key("y")));
  EXPECT_TRUE(std::move(walk).Finish().trimmed) << "one less is not full, so the rest is gone";
}

TEST_F(ChangeWalkTest, AnOlderCopyOfTheStoreIsNoticed) {
  last_.writers[kA] = {4, kNow};
  EXPECT_TRUE(std::move(Walk()).Finish().trimmed) << "5 was read, and is not there";
}

TEST_F(ChangeWalkTest, AWriterThatWentForItsAgeTookNothingUnread) {
  last_.writers.clear();
  from_.writers[kA].noted_at = last_.read_at - kChangeWriterKept;
  const SharedChanges changes = std::move(Walk()).Finish();
  EXPECT_FALSE(changes.trimmed);
  EXPECT_THAT(changes.positions.writers, IsEmpty());
  from_.writers[kA].noted_at += seconds(1);
  EXPECT_TRUE(std::move(Walk()).Finish().trimmed) << "it was not old enough to go";
}

TEST_F(ChangeWalkTest, WhoDidNotReadForTooLongReadsAllAnew) {
  last_.writers[kA] = {5, kNow};
  last_.read_at = from_.read_at + kChangesReadWithin - seconds(1);
  EXPECT_FALSE(std::move(Walk()).Finish().trimmed);
  last_.read_at += seconds(1);
  EXPECT_TRUE(std::move(Walk()).Finish().trimmed);
}

}  // namespace
}  // namespace uplink::storage
