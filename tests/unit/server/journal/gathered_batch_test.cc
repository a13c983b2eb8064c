#include "server/journal/gathered_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class GatheredBatchTest : public ::testing::Test {
 protected:
  void Add(RecordingClient& client, model::Seq seq) { batch_.Add(StepBench::EntryOf(client, seq)); }
  void AddGap(RecordingClient& client, model::Seq first) {
    batch_.Add(StepBench::GapEntryOf(client, first));
  }
  void SetPresence(std::size_t count) {
    std::vector<storage::PresenceItem> items(count);
    for (std::size_t i = 0; i < count; ++i) items[i].number = i + 1;
    batch_.SetPresence(std::move(items));
  }

  metrics::Ledger ledger_;
  RecordingClient a_{"rcan://a"};
  RecordingClient b_{"rcan://b"};
  GatheredBatch batch_{model::SessionId(storage::ProcessId{7})};
};

TEST_F(GatheredBatchTest, IsEmptyWithNeitherRecordsNorGapsNorPresence) {
  EXPECT_TRUE(batch_.empty());
  SetPresence(1);
  EXPECT_FALSE(batch_.empty());
  EXPECT_EQ(batch_.entries(), 0U);
  batch_.ClearPresence();
  EXPECT_TRUE(batch_.empty());
  AddGap(a_, 1);
  EXPECT_FALSE(batch_.empty());
  batch_.ClearEntries();
  EXPECT_TRUE(batch_.empty());
  EXPECT_EQ(batch_.batch().presence_session, model::SessionId(storage::ProcessId{7}));
}

TEST_F(GatheredBatchTest, KeepsOwnersInTheOrderOfTheirRecordsAndGaps) {
  Add(a_, 1);
  AddGap(b_, 2);
  Add(b_, 3);
  EXPECT_THAT(SeqsOf(batch_.batch()), ElementsAre(1, 3, 2));
  ASSERT_THAT(batch_.origins(), SizeIs(2));
  EXPECT_EQ(batch_.origins()[0].client, &a_);
  EXPECT_EQ(batch_.origins()[1].client, &b_);
  ASSERT_THAT(batch_.gap_origins(), SizeIs(1));
  EXPECT_EQ(batch_.gap_origins()[0].client, &b_);
  EXPECT_EQ(batch_.entries(), 3U);
  EXPECT_EQ(batch_.bytes(), 6U);
}

TEST_F(GatheredBatchTest, TheLongestOfItsListsCounts) {
  Add(a_, 1);
  EXPECT_EQ(batch_.longest(), 1U);
  AddGap(a_, 2);
  AddGap(a_, 3);
  EXPECT_EQ(batch_.longest(), 2U);
  SetPresence(3);
  EXPECT_EQ(batch_.longest(), 3U);
}

TEST_F(GatheredBatchTest, DropsWhatBecameVoidAndKeepsTheOrderOfTheRest) {
  Add(a_, 1);
  Add(b_, 2);
  Add(a_, 3);
  Add(b_, 4);
  AddGap(a_, 5);
  AddGap(b_, 6);
  static_cast<void>(a_.OnFenced(ledger_));
  const GatheredBatch::Dropped dropped = batch_.DropVoid();
  EXPECT_EQ(dropped.entries, 3U);
  EXPECT_EQ(dropped.bytes, 9U);
  EXPECT_THAT(dropped.gap_clients, ElementsAre(&a_));
  EXPECT_THAT(SeqsOf(batch_.batch()), ElementsAre(2, 4, 6));
  for (const Origin& origin : batch_.origins()) EXPECT_EQ(origin.client, &b_);
  EXPECT_EQ(batch_.DropVoid().entries, 0U);
}

TEST_F(GatheredBatchTest, WritesTheHoldIntoRecordsAndGaps) {
  HeldRobots held;
  held.Begin(a_, 3);
  held.Begin(b_, 5);
  Add(a_, 1);
  Add(b_, 2);
  AddGap(b_, 3);
  batch_.SetHolds(held);
  EXPECT_EQ(batch_.batch().records[0].held_since, 3U);
  EXPECT_EQ(batch_.batch().records[1].held_since, 5U);
  EXPECT_EQ(batch_.batch().gaps[0].held_since, 5U);
}

TEST_F(GatheredBatchTest, TheRestIsWhatLiesBehindTheFirstOfEach) {
  for (model::Seq seq = 1; seq <= 3; ++seq) Add(a_, seq);
  for (model::Seq first = 10; first <= 12; ++first) AddGap(b_, first);
  SetPresence(3);
  batch_.MarkTried();
  const GatheredBatch::Rest rest = batch_.TakeRest(1);
  EXPECT_THAT(SeqsOf(batch_.batch()), ElementsAre(1, 10));
  EXPECT_THAT(batch_.batch().presence, SizeIs(1));
  EXPECT_EQ(batch_.entries(), 2U);
  ASSERT_THAT(rest.entries, SizeIs(4));
  EXPECT_EQ(std::get<storage::CommitRecord>(rest.entries[0].item).seq, 2U);
  EXPECT_EQ(std::get<storage::CommitRecord>(rest.entries[1].item).seq, 3U);
  EXPECT_EQ(std::get<storage::GapItem>(rest.entries[2].item).first, 11U);
  EXPECT_EQ(std::get<storage::GapItem>(rest.entries[3].item).first, 12U);
  EXPECT_TRUE(rest.entries[0].origin.tried) << "it may have been stored";
  EXPECT_FALSE(rest.entries[2].origin.tried) << "of a gap there is nothing to tell";
  ASSERT_THAT(rest.presence, SizeIs(2));
  EXPECT_EQ(rest.presence[0].number, 2U);
}

TEST_F(GatheredBatchTest, ThereIsNoRestBehindAsManyAsItHolds) {
  Add(a_, 1);
  AddGap(a_, 2);
  SetPresence(1);
  const GatheredBatch::Rest rest = batch_.TakeRest(1);
  EXPECT_THAT(rest.entries, IsEmpty());
  EXPECT_THAT(rest.presence, IsEmpty());
  EXPECT_EQ(batch_.entries(), 2U);
}

}  // namespace
}  // namespace uplink::journal
