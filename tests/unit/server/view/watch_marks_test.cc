#include "server/view/watch_marks.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::view {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::size_t> TakeAll(WatchMarks& marks) {
  std::vector<std::size_t> robots;
  while (const auto robot = marks.TakeRobot()) robots.push_back(*robot);
  return robots;
}

TEST(NumberSet, FindsItsNumbersInOrder) {
  NumberSet set;
  EXPECT_TRUE(set.empty());
  for (const std::size_t number : {200U, 0U, 63U, 64U, 64U}) set.Add(number);
  EXPECT_EQ(set.NextFrom(0), 0U);
  EXPECT_EQ(set.NextFrom(1), 63U);
  EXPECT_EQ(set.NextFrom(64), 64U);
  EXPECT_EQ(set.NextFrom(65), 200U);
  EXPECT_EQ(set.NextFrom(201), std::nullopt);
  EXPECT_EQ(set.NextFrom(100'000), std::nullopt);
  EXPECT_TRUE(set.Remove(64));
  EXPECT_FALSE(set.Remove(64));
  EXPECT_FALSE(set.Remove(100'000));
  for (const std::size_t number : {200U, 0U, 63U}) set.Remove(number);
  EXPECT_TRUE(set.empty());
}

TEST(WatchMarks, BeginWithASnapshotAndItsEnd) {
  WatchMarks marks;
  marks.Show(3);
  marks.Show(1);
  EXPECT_EQ(marks.TakeSnapshotEnd(), std::nullopt);
  EXPECT_THAT(TakeAll(marks), ElementsAre(1, 3));
  EXPECT_TRUE(marks.any());
  EXPECT_EQ(marks.TakeSnapshotEnd(), 2);
  EXPECT_EQ(marks.TakeSnapshotEnd(), std::nullopt);
  EXPECT_FALSE(marks.any());
}

TEST(WatchMarks, OfNoRobotAreAnEmptySnapshot) {
  WatchMarks marks;
  EXPECT_TRUE(marks.any());
  EXPECT_EQ(marks.TakeSnapshotEnd(), 0);
}

TEST(WatchMarks, EndTheSnapshotThoughRobotsChangeMeanwhile) {
  WatchMarks marks;
  marks.Show(1);
  marks.Show(2);
  EXPECT_EQ(marks.TakeRobot(), 1U);
  marks.Show(1);
  EXPECT_EQ(marks.TakeRobot(), 2U);
  EXPECT_EQ(marks.TakeRobot(), std::nullopt);
  EXPECT_EQ(marks.TakeSnapshotEnd(), 2);
  EXPECT_EQ(marks.TakeRobot(), 1U);
}

TEST(WatchMarks, ShowARobotOnceHoweverOftenItChanged) {
  WatchMarks marks;
  for (int i = 0; i < 1'000; ++i) marks.Show(7);
  EXPECT_THAT(TakeAll(marks), ElementsAre(7));
  EXPECT_THAT(TakeAll(marks), IsEmpty());
}

TEST(WatchMarks, GiveEachRobotItsTurn) {
  WatchMarks marks;
  static_cast<void>(marks.TakeSnapshotEnd());
  marks.Show(1);
  marks.Show(2);
  EXPECT_EQ(marks.TakeRobot(), 1U);
  marks.Show(1);
  EXPECT_EQ(marks.TakeRobot(), 2U);
  marks.Show(2);
  EXPECT_EQ(marks.TakeRobot(), 1U);
}

TEST(WatchMarks, TellOfARobotThatIsGoneOnlyIfItWasShown) {
  WatchMarks marks;
  marks.Show(1);
  marks.Show(2);
  EXPECT_EQ(marks.TakeRobot(), 1U);
  marks.Hide(1, "a");
  marks.Hide(1, "a");
  marks.Hide(2, "b");
  EXPECT_EQ(marks.TakeRemoved(), "a");
  EXPECT_EQ(marks.TakeRemoved(), std::nullopt);
  EXPECT_EQ(marks.TakeRobot(), std::nullopt);
}

TEST(WatchMarks, PutBackWhatWasNotShown) {
  WatchMarks marks;
  for (const std::size_t robot : {1U, 2U, 3U}) marks.Show(robot);
  EXPECT_THAT(TakeAll(marks), ElementsAre(1, 2, 3));
  marks.PutBack(3);
  marks.PutBack(2);
  EXPECT_EQ(marks.TakeSnapshotEnd(), std::nullopt);
  EXPECT_THAT(TakeAll(marks), ElementsAre(2, 3));
  EXPECT_EQ(marks.TakeSnapshotEnd(), 3);
}

}  // namespace
}  // namespace uplink::view
