#include "server/journal/ask_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::uint64_t> IdsOf(const std::vector<OpenEntry>& entries) {
  std::vector<std::uint64_t> ids;
  ids.reserve(entries.size());
  for (const OpenEntry& entry : entries) ids.push_back(entry.open_id);
  return ids;
}

class AskQueueTest : public ::testing::Test {
 protected:
  bool Push(RecordingClient& client, std::uint64_t open_id) {
    return queue_.Push(StepBench::OpenOf(client, open_id));
  }

  RecordingClient a_{"rcan://a"};
  RecordingClient b_{"rcan://b"};
  RecordingClient c_{"rcan://c"};
  OpenQueue queue_;
};

TEST_F(AskQueueTest, HandsOverInOrderAtMostSoMany) {
  EXPECT_TRUE(queue_.empty());
  EXPECT_TRUE(Push(a_, 1));
  EXPECT_TRUE(Push(b_, 2));
  EXPECT_TRUE(Push(c_, 3));
  EXPECT_THAT(IdsOf(queue_.MoveTo({}, 2)), ElementsAre(1, 2));
  EXPECT_FALSE(queue_.empty());
  EXPECT_THAT(IdsOf(queue_.MoveTo({}, 2)), ElementsAre(3));
  EXPECT_TRUE(queue_.empty());
  EXPECT_THAT(queue_.MoveTo({}, 2), IsEmpty());
}

TEST_F(AskQueueTest, ANewerOneTakesThePlaceOfTheOneThatWaits) {
  Push(a_, 1);
  Push(b_, 2);
  EXPECT_FALSE(Push(a_, 3));
  EXPECT_EQ(queue_.unanswered(), 2U);
  EXPECT_THAT(IdsOf(queue_.MoveTo({}, 9)), ElementsAre(3, 2));
}

TEST_F(AskQueueTest, ANewerOneTakesThePlaceOfTheOneThatWasTaken) {
  Push(a_, 1);
  Push(b_, 2);
  std::vector<OpenEntry> taken = queue_.MoveTo({}, 9);
  Push(a_, 3);
  EXPECT_EQ(queue_.unanswered(), 3U);
  taken = queue_.MoveTo(std::move(taken), 3);
  EXPECT_THAT(IdsOf(taken), ElementsAre(3, 2));
  EXPECT_EQ(queue_.unanswered(), 2U);
}

TEST_F(AskQueueTest, ACallThatIsFullTakesNoMore) {
  Push(a_, 1);
  const std::vector<OpenEntry> taken = queue_.MoveTo({}, 1);
  Push(a_, 2);
  EXPECT_THAT(IdsOf(queue_.MoveTo(taken, 1)), ElementsAre(1));
  EXPECT_FALSE(queue_.empty());
}

TEST_F(AskQueueTest, WhatIsPutBackGoesFirstInItsOrder) {
  Push(a_, 1);
  Push(b_, 2);
  std::vector<OpenEntry> taken = queue_.MoveTo({}, 9);
  Push(c_, 3);
  queue_.PutBack(std::move(taken));
  EXPECT_EQ(queue_.unanswered(), 3U);
  EXPECT_THAT(IdsOf(queue_.MoveTo({}, 9)), ElementsAre(1, 2, 3));
}

TEST_F(AskQueueTest, ANewerOneStandsForWhatIsPutBack) {
  Push(a_, 1);
  Push(b_, 2);
  std::vector<OpenEntry> taken = queue_.MoveTo({}, 9);
  Push(a_, 3);
  queue_.PutBack(std::move(taken));
  EXPECT_EQ(queue_.unanswered(), 2U);
  EXPECT_THAT(IdsOf(queue_.MoveTo({}, 9)), ElementsAre(2, 3));
}

TEST_F(AskQueueTest, WhatWasTakenCountsUntilItIsAnswered) {
  Push(a_, 1);
  Push(b_, 2);
  EXPECT_THAT(queue_.MoveTo({}, 9), Not(IsEmpty()));
  EXPECT_EQ(queue_.unanswered(), 2U);
  queue_.CountAnswered(2);
  EXPECT_EQ(queue_.unanswered(), 0U);
}

}  // namespace
}  // namespace uplink::journal
