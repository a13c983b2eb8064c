#include "server/journal/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class JournalTest : public ::testing::Test {
 protected:
  CountingInbox inbox_;
  RecordingClient robot_{"rcan://bench/1", {.inbox = &inbox_, .stream = 1}};
  RecordingClient other_{"rcan://bench/2", {.inbox = &inbox_, .stream = 2}};
};

TEST_F(JournalTest, WithNothingToDoIsIdle) {
  JournalBench bench;
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kIdle);
  EXPECT_TRUE(bench.journal.idle());
  EXPECT_EQ(bench.store.commits(), 0U);
}

TEST_F(JournalTest, OpensBeforeItCommits) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Append(robot_, 1);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1"));
  EXPECT_EQ(inbox_.wakes(1), 1);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1));
  EXPECT_THAT(robot_.Told(), IsEmpty()) << "telling is a step of its own";
  EXPECT_FALSE(bench.journal.idle());
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1"));
  EXPECT_EQ(inbox_.wakes(1), 2);
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, OneCommitTakesAllThatWaitsInOrder) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Open(other_);
  bench.Append(robot_, 1);
  bench.Append(other_, 7);
  bench.Append(robot_, 2);
  bench.Append(robot_, 3);
  bench.Run();
  EXPECT_EQ(bench.store.commits(), 1U);
  EXPECT_EQ(bench.store.opens(), 1U);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1 2 3"));
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1", "settled 7"));
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1, 2, 3));
}

TEST_F(JournalTest, ABatchHasAtMostItsRecordsGapsIncluded) {
  JournalBench bench({.batch_records_max = 3});
  bench.Open(robot_);
  bench.AppendGap(robot_, 1, 1);
  for (model::Seq seq = 2; seq <= 6; ++seq) bench.Append(robot_, seq);
  bench.Run();
  EXPECT_EQ(bench.store.commits(), 2U);
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 2 3", "gaps 1", "settled 4 5 6"));
}

TEST_F(JournalTest, ABatchEndsOnceItHasItsBytes) {
  JournalBench bench({.batch_bytes_max = 3000});
  bench.Open(robot_);
  for (model::Seq seq = 1; seq <= 4; ++seq) bench.Append(robot_, seq, std::string(1000, 'x'));
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1 2", "settled 3 4"));
}

TEST_F(JournalTest, ARecordOverTheBatchBytesStillGoes) {
  JournalBench bench({.batch_bytes_max = 100});
  bench.Open(robot_);
  bench.Append(robot_, 1, std::string(5000, 'x'));
  bench.Append(robot_, 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1", "settled 2"));
}

TEST_F(JournalTest, ANewerOpenReplacesAQueuedOne) {
  JournalBench bench;
  bench.Open(robot_, 1);
  bench.Open(robot_, 2);
  EXPECT_FALSE(bench.journal.idle());
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 2"));
  EXPECT_EQ(bench.database.EpochOf("rcan://bench/1"), 1U);
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, ANewerOpenReplacesOneThatTheStoreFailed) {
  JournalBench bench;
  bench.Open(robot_, 1);
  bench.store.FailNext(1, testing::FailAt::kBefore);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kFailed);
  bench.Open(robot_, 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 2"));
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, AFailedCommitIsTriedAgainAsItWas) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Append(robot_, 1);
  bench.Append(robot_, 2);
  bench.store.FailNextCommits(2, testing::FailAt::kBefore);
  bench.Run();
  bench.Append(robot_, 3);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(bench.journal.last_error().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(bench.probe.store_failing.value(), 1);
  EXPECT_EQ(bench.probe.store_errors.value(), 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1 2", "settled 3"));
  EXPECT_TRUE(bench.journal.last_error().ok());
  EXPECT_EQ(bench.probe.store_failing.value(), 0);
}

TEST_F(JournalTest, ALostAnswerIsAskedForWithTheSameBatch) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Append(robot_, 1);
  bench.Append(robot_, 2);
  bench.store.FailNextCommits(1, testing::FailAt::kAfter);
  bench.Run();
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1, 2));
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1")) << "not known to be durable";
  bench.Append(robot_, 3);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1 2", "settled 3"))
      << "our own earlier try stored them: they count as stored, not as duplicates";
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1, 2, 3));
}

TEST_F(JournalTest, AfterABrokenConnectionTheStoreIsComparedBeforeItsAnswerIsAskedFor) {
  JournalBench bench;
  int reconnects = 0;
  bench.journal.OnReconnected([&](Reconnected) {
    ++reconnects;
    EXPECT_THAT(robot_.Told(), IsEmpty()) << "nothing is told before";
  });
  bench.Open(robot_);
  bench.Append(robot_, 1);
  bench.Append(robot_, 2);
  bench.store.FailNextCommits(1, testing::FailAt::kAfter);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1"));
  bench.store.Break();
  bench.Append(robot_, 3);
  bench.Run();
  EXPECT_EQ(bench.store.compares(), 1U);
  EXPECT_EQ(reconnects, 1);
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1 2 3"));
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1, 2, 3));
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, ARecordOfALostRobotEndsItsStreamAndIsTakenAfterTheNextOpen) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Open(other_);
  bench.Append(robot_, 1);
  bench.Run();
  bench.database.DeleteRobotRow(robot_.robot()->ruri);
  bench.Append(robot_, 2);
  bench.Append(other_, 1);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1", "fenced"));
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1", "settled 1")) << "the rest of the batch";
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1));
  EXPECT_EQ(bench.database.EpochOf(robot_.robot()->ruri), 0U) << "it was not made anew";
  bench.Open(robot_, 2);
  bench.Append(robot_, 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 2", "settled 2"));
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(1, 2));
}

TEST_F(JournalTest, AStaleHoldOfARobotThatCameAnewElsewhereIsFenced) {
  JournalBench bench;
  testing::FakeStore elsewhere(bench.database, storage::ProcessId{2});
  bench.Open(robot_);
  for (std::uint64_t i = 2; i <= 5; ++i) bench.Open(robot_, i);
  bench.Run();
  bench.database.DeleteRobotRow(robot_.robot()->ruri);
  const storage::OpenRequest request{.robot = robot_.robot(), .session = JournalBench::kSession};
  ASSERT_FALSE(elsewhere.OpenStreams({&request, 1})->front().was_known);
  static_cast<void>(robot_.Told());
  bench.Append(robot_, 1);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
  EXPECT_THAT(bench.Stored(robot_), IsEmpty());
}

TEST_F(JournalTest, OpensGoAheadOfABatchThatFailed) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Append(robot_, 1);
  bench.store.FailNextCommits(1, testing::FailAt::kBefore);
  bench.Run();
  bench.Open(other_);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1"));
  EXPECT_THAT(bench.Stored(robot_), IsEmpty());
}

TEST_F(JournalTest, QuarantineIsSettledWithItsReason) {
  JournalBench bench;
  bench.Open(robot_);
  bench.journal.AppendMessage(
      robot_, robot_.generation(),
      {{.robot = robot_.robot(),
        .session = JournalBench::kSession,
        .seq = 1,
        .received_at = bench.clock.System(),
        .content = storage::QuarantineItem{{model::RejectReason::kMalformed, "", "cut"}}}},
      bench.clock.Steady());
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1 rejected"));
}

TEST_F(JournalTest, AStormOfStreamsKeepsNoCommitWaiting) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Run();
  bench.Append(robot_, 1);
  RecordingClient storm("rcan://storm");
  for (std::uint64_t i = 1; i <= 6; ++i) {
    bench.Open(storm, i);
    bench.journal.turns().Advance();
  }
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "settled 1"));
  EXPECT_THAT(storm.Told(), Not(IsEmpty()));
}

TEST_F(JournalTest, OpensAtMostSoManyStreamsACall) {
  JournalBench bench;
  std::vector<std::unique_ptr<RecordingClient>> many;
  for (std::size_t i = 0; i <= kOpensPerCallMax; ++i) {
    many.push_back(std::make_unique<RecordingClient>("rcan://" + std::to_string(i)));
    bench.Open(*many.back());
  }
  bench.journal.turns().Advance();
  EXPECT_THAT(many[kOpensPerCallMax - 1]->Told(), ElementsAre("opened 1"));
  EXPECT_THAT(many[kOpensPerCallMax]->Told(), IsEmpty());
  bench.Run();
  EXPECT_THAT(many[kOpensPerCallMax]->Told(), ElementsAre("opened 1"));
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, RoomEndsAtItsBytes) {
  JournalBench bench({.bytes_max = 2000});
  bench.Open(robot_);
  bench.Append(robot_, 1, std::string(400, 'x'));
  EXPECT_TRUE(bench.journal.HasRoom());
  bench.Append(robot_, 2, std::string(574, 'x'));
  EXPECT_TRUE(bench.journal.HasRoom()) << "two bytes are left";
  EXPECT_EQ(bench.journal.bytes(), 1998U);
  bench.Append(robot_, 3);
  EXPECT_FALSE(bench.journal.HasRoom());
  bench.Run();
  EXPECT_TRUE(bench.journal.HasRoom());
  EXPECT_EQ(bench.journal.bytes(), 0U);
}

TEST_F(JournalTest, RoomEndsAtItsRecords) {
  JournalBench bench({.records_max = 2});
  bench.Open(robot_);
  bench.Append(robot_, 1);
  EXPECT_TRUE(bench.journal.HasRoom());
  bench.Append(robot_, 2);
  EXPECT_FALSE(bench.journal.HasRoom());
  EXPECT_EQ(bench.journal.records(), 2U);
}

TEST_F(JournalTest, WhenRoomWakesOnceAfterTheCommit) {
  JournalBench bench({.records_max = 1});
  const loop::StreamRef waiter{.inbox = &inbox_, .stream = 9};
  bench.Open(robot_);
  bench.Append(robot_, 1);
  bench.journal.WhenRoom(waiter);
  bench.journal.WhenRoom(waiter);
  EXPECT_EQ(inbox_.wakes(9), 0);
  bench.Run();
  EXPECT_EQ(inbox_.wakes(9), 1);
  bench.Append(robot_, 2);
  bench.Run();
  EXPECT_EQ(inbox_.wakes(9), 1) << "it asked for one wake";
}

TEST_F(JournalTest, WhenRoomWakesAtOnceWhereThereIsRoom) {
  JournalBench bench;
  bench.journal.WhenRoom({.inbox = &inbox_, .stream = 9});
  EXPECT_EQ(inbox_.wakes(9), 1);
}

TEST_F(JournalTest, OldestIsTheAgeOfTheFirstThatWaits) {
  JournalBench bench({.batch_records_max = 1});
  bench.Open(robot_);
  EXPECT_EQ(bench.journal.oldest(bench.clock.Steady()), milliseconds(0));
  bench.Append(robot_, 1);
  bench.clock.Advance(milliseconds(70));
  bench.Append(robot_, 2);
  bench.clock.Advance(milliseconds(30));
  EXPECT_EQ(bench.journal.oldest(bench.clock.Steady()), milliseconds(100));
  bench.store.FailNextCommits(1, testing::FailAt::kBefore);
  bench.Run();
  EXPECT_EQ(bench.journal.oldest(bench.clock.Steady()), milliseconds(100)) << "in the batch";
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(bench.journal.oldest(bench.clock.Steady()), milliseconds(30));
  bench.Run();
  EXPECT_EQ(bench.journal.oldest(bench.clock.Steady()), milliseconds(0));
}

TEST_F(JournalTest, ARefusedHoldFencesItsRobotAlone) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Open(other_);
  bench.Run();
  testing::FakeStore elsewhere(bench.database, storage::ProcessId{2});
  ASSERT_TRUE(
      elsewhere.OpenStreams(std::vector{storage::OpenRequest{.robot = robot_.robot()}}).ok());
  bench.Append(robot_, 1);
  bench.Append(other_, 1);
  bench.Append(robot_, 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "fenced"));
  EXPECT_THAT(other_.Told(), ElementsAre("opened 1", "settled 1"));
  EXPECT_THAT(bench.Stored(robot_), IsEmpty());
}

TEST_F(JournalTest, AnInterruptedHoldFencesAtTheOpen) {
  JournalBench bench;
  bench.Open(robot_, 1);
  bench.Run();
  testing::FakeStore elsewhere(bench.database, storage::ProcessId{2});
  ASSERT_TRUE(
      elsewhere.OpenStreams(std::vector{storage::OpenRequest{.robot = robot_.robot()}}).ok());
  bench.Open(robot_, 2);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "fenced"));
  bench.Open(robot_, 3);
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 3"));
}

TEST_F(JournalTest, VoidEntriesAreDroppedUnwritten) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Open(other_);
  bench.Append(robot_, 1);
  bench.AppendGap(robot_, 2, 4);
  bench.Append(other_, 1);
  bench.Append(robot_, 5);
  static_cast<void>(robot_.OnFenced(bench.ledger));
  bench.Append(robot_, 6);
  bench.Run();
  EXPECT_THAT(bench.Stored(robot_), ElementsAre(6));
  EXPECT_THAT(bench.Stored(other_), ElementsAre(1));
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced", "opened 1", "gaps 1", "settled 6"));
  EXPECT_TRUE(bench.journal.idle());
  EXPECT_EQ(bench.journal.bytes(), 0U);
}

TEST_F(JournalTest, WhatBecomesVoidDuringItsCommitIsNotTold) {
  JournalBench bench;
  bench.Open(robot_);
  bench.Append(robot_, 1);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(bench.journal.turns().Advance(), Step::kWorked);
  static_cast<void>(robot_.OnFenced(bench.ledger));
  bench.Run();
  EXPECT_THAT(robot_.Told(), ElementsAre("opened 1", "fenced"));
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(JournalTest, CommitsAreMeasured) {
  JournalBench bench;
  bench.Open(robot_);
  for (model::Seq seq = 1; seq <= 3; ++seq) bench.Append(robot_, seq);
  bench.Run();
  EXPECT_EQ(bench.probe.commit_records.sum(), 3);
}

}  // namespace
}  // namespace uplink::journal
