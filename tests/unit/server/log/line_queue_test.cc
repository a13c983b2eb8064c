#include "server/log/line_queue.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/eventually.h"

namespace uplink::log {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr milliseconds kPatience = testing::kPatience;

TEST(LineQueueTest, KeepsTheOrder) {
  LineQueue queue({});
  queue.Push("a");
  queue.Push("b");
  const auto taken = queue.Take();
  ASSERT_TRUE(taken);
  EXPECT_THAT(taken->lines, ElementsAre("a", "b"));
  EXPECT_EQ(taken->lost, 0U);
}

TEST(LineQueueTest, DropsTheLineThatIsOneTooMany) {
  LineQueue queue({.lines_max = 2, .bytes_max = 100});
  for (const char* line : {"a", "b", "c", "d"}) queue.Push(line);
  EXPECT_EQ(queue.counts().waiting, 2U);
  EXPECT_EQ(queue.counts().dropped, 2U);
  const auto taken = queue.Take();
  ASSERT_TRUE(taken);
  EXPECT_THAT(taken->lines, ElementsAre("a", "b"));
  EXPECT_EQ(taken->lost, 2U) << "told once, behind the lines before them";
  queue.Push("e");
  EXPECT_EQ(queue.counts().dropped, 3U) << "those that are being written have their place";
}

TEST(LineQueueTest, DropsTheLineThatIsOneByteTooMany) {
  LineQueue queue({.lines_max = 10, .bytes_max = 8});
  queue.Push("four");
  queue.Push("five!");
  queue.Push("for");
  queue.Push("x");
  queue.Push("y");
  EXPECT_EQ(queue.counts().waiting, 3U);
  EXPECT_EQ(queue.counts().dropped, 2U);
}

TEST(LineQueueTest, HasRoomAgainOnceWhatWasTakenIsWritten) {
  LineQueue queue({.lines_max = 2, .bytes_max = 100});
  queue.Push("a");
  ASSERT_TRUE(queue.Take());
  queue.Push("b");
  queue.Push("lost");
  const auto second = queue.Take();
  ASSERT_TRUE(second);
  EXPECT_THAT(second->lines, ElementsAre("b"));
  EXPECT_EQ(second->lost, 1U);
  queue.Push("c");
  EXPECT_EQ(queue.counts().waiting, 2U);
  EXPECT_EQ(queue.counts().dropped, 1U);
}

TEST(LineQueueTest, TellsALossWithoutAnotherLine) {
  LineQueue queue({.lines_max = 1, .bytes_max = 100});
  queue.Push("a");
  ASSERT_TRUE(queue.Take());
  queue.Push("lost");
  queue.Close();  // a Take that waits for a line ends
  const auto loss = queue.Take();
  ASSERT_TRUE(loss);
  EXPECT_THAT(loss->lines, IsEmpty());
  EXPECT_EQ(loss->lost, 1U);
  EXPECT_FALSE(queue.Take());
}

TEST(LineQueueTest, GivesTheRestAfterItsEndAndTakesNothingMore) {
  LineQueue queue({});
  queue.Push("a");
  queue.Close();
  queue.Push("late");
  EXPECT_EQ(queue.counts().dropped, 1U);
  ASSERT_TRUE(queue.Take());
  EXPECT_FALSE(queue.Take());
}

TEST(LineQueueTest, WaitsForWhatCameBefore) {
  LineQueue queue({});
  queue.WaitUntilWritten(kPatience);
  queue.Push("a");
  std::jthread writer([&] {
    while (queue.Take()) {
    }
  });
  queue.WaitUntilWritten(kPatience);
  EXPECT_EQ(queue.counts().waiting, 0U);
  queue.Close();
}

TEST(LineQueueTest, WaitsNoLongerThanItMay) {
  LineQueue queue({});
  queue.Push("a");
  queue.WaitUntilWritten(milliseconds(1));
  ASSERT_TRUE(queue.Take());
  queue.WaitUntilWritten(milliseconds(1));
  EXPECT_EQ(queue.counts().waiting, 1U) << "it was taken, and is not written";
}

}  // namespace
}  // namespace uplink::log
