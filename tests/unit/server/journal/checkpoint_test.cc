#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"
#include "tests/unit/server/journal/listed_rows.h"

/// Live states are written alternately with what waits.
namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::chrono::seconds kEvery{5};

class JournalCheckpoint : public ::testing::Test, protected JournalBench {
 protected:
  JournalCheckpoint() {
    journal.CheckpointFrom(live_, kEvery);
    Open(client_);
    Run();
  }
  using JournalBench::Run;

  std::vector<storage::LiveRow> Written() {
    return store.LiveOf(std::vector<std::string>{"rcan://a"})->rows;
  }

  RecordingClient client_{"rcan://a"};
  ListedRows live_;
};

TEST_F(JournalCheckpoint, WritesARoundWhenItIsDue) {
  live_.Add("rcan://a");
  clock.Advance(kEvery - milliseconds(1));
  Run();
  EXPECT_THAT(Written(), IsEmpty());
  clock.Advance(milliseconds(1));
  Run();
  EXPECT_THAT(Written(), SizeIs(1));
  EXPECT_EQ(live_.rounds, 1);
  EXPECT_EQ(probe.checkpoint_robots.value(), 1);
  Run();
  EXPECT_EQ(live_.rounds, 1) << "the next is due later";
  clock.Advance(kEvery);
  Run();
  EXPECT_EQ(live_.rounds, 2);
}

TEST_F(JournalCheckpoint, CountsWhatWasWrittenAndGivesBackWhatWasNot) {
  live_.Add("rcan://not ours yet");
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  Run();
  EXPECT_EQ(probe.checkpoint_robots.value(), 1);
  EXPECT_THAT(live_.passed_over, ElementsAre("rcan://not ours yet"));
  EXPECT_EQ(live_.put_back, 0U);
}

TEST_F(JournalCheckpoint, WhatWaitsGoesFirstAndBetweenTwoCalls) {
  for (int i = 0; i < 3; ++i) live_.Add("rcan://a");
  clock.Advance(kEvery);
  Append(client_, 1);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(Stored(client_), ElementsAre(1U));
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked) << "it is told";
  EXPECT_EQ(store.checkpoints(), 0U);
  Append(client_, 2);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(store.checkpoints(), 1U) << "its turn, though a record waits";
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(Stored(client_), ElementsAre(1U, 2U));
  Run();
  EXPECT_EQ(store.checkpoints(), 3U);
}

TEST_F(JournalCheckpoint, AfterAFailureItAsksForLess) {
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  clock.Advance(kEvery);
  Run();
  EXPECT_THAT(live_.rows_max_asked,
              ElementsAre(storage::kCheckpointRowsMax, storage::kCheckpointRowsMax / 2,
                          storage::kCheckpointRowsMax));
}

TEST_F(JournalCheckpoint, ARowThatIsRefusedKeepsNoOtherFromBeingWritten) {
  live_.Add("rcan://a");
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore, absl::InternalError("refused"));
  Run();
  EXPECT_EQ(live_.rounds, 1);
  EXPECT_EQ(store.checkpoints(), 2U);
  EXPECT_THAT(Written(), SizeIs(1));
}

TEST_F(JournalCheckpoint, WhileTheStoreIsAwayTheRowsGoBack) {
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(live_.put_back, 1U);
  EXPECT_EQ(probe.store_failing.value(), 1);
  EXPECT_EQ(probe.checkpoint_failing.value(), 0);
  Append(client_, 1);
  Run();
  EXPECT_THAT(Stored(client_), ElementsAre(1U)) << "no commit waits for it";
  EXPECT_EQ(store.checkpoints(), 1U);
  clock.Advance(kEvery);
  Run();
  EXPECT_THAT(Written(), SizeIs(1));
}

TEST_F(JournalCheckpoint, ThatItWorksDoesNotHideCommitsThatFail) {
  Append(client_, 1);
  store.FailNextCommits(2, FailAt::kBefore, absl::ResourceExhaustedError("disk full"));
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(store.checkpoints(), 1U);
  EXPECT_TRUE(absl::IsResourceExhausted(journal.last_error()));
  EXPECT_EQ(probe.store_failing.value(), 1);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(probe.store_failing.value(), 1);
  Run();
  EXPECT_TRUE(journal.last_error().ok());
  EXPECT_EQ(probe.store_failing.value(), 0);
}

TEST_F(JournalCheckpoint, ATroubleOfItsOwnIsNotTheStores) {
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  store.FailNextCheckpoints(1, FailAt::kBefore, absl::InternalError("no such table"));
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(live_.put_back, 1U);
  EXPECT_EQ(probe.store_failing.value(), 0);
  EXPECT_EQ(probe.checkpoint_failing.value(), 1);
  EXPECT_FALSE(journal.checkpoint_error().ok());
  Run();
  clock.Advance(kEvery);
  Run();
  EXPECT_EQ(probe.checkpoint_failing.value(), 0);
  EXPECT_TRUE(journal.checkpoint_error().ok());
}

TEST_F(JournalCheckpoint, OneThatWasAskedForKeepsTheJournalBusyUntilItsEnd) {
  EXPECT_TRUE(journal.idle());
  live_.Add("rcan://a");
  journal.RequestCheckpoint();
  EXPECT_FALSE(journal.idle());
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_FALSE(journal.idle()) << "there may be more";
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(Written(), SizeIs(1));
}

TEST_F(JournalCheckpoint, OneThatWasAskedForDuringARoundBeginsAfterIt) {
  live_.Add("rcan://a");
  clock.Advance(kEvery);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  journal.RequestCheckpoint();
  Run();
  EXPECT_EQ(live_.rounds, 2);
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalCheckpoint, OneThatWasAskedForIsTriedUntilTheStoreIsThere) {
  live_.Add("rcan://a");
  journal.RequestCheckpoint();
  store.FailNextCheckpoints(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_FALSE(journal.idle());
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(Written(), SizeIs(1));
}

TEST_F(JournalCheckpoint, OneThatWasAskedForIsGivenUpWhereTheStoreRefusesIt) {
  live_.Add("rcan://a");
  journal.RequestCheckpoint();
  store.FailNextCheckpoints(1, FailAt::kBefore, absl::InternalError("no such table"));
  Run();
  EXPECT_TRUE(journal.idle());
}

TEST(JournalWithoutCheckpoints, IsIdleWhenOneIsAskedFor) {
  JournalBench bench;
  bench.journal.RequestCheckpoint();
  EXPECT_TRUE(bench.journal.idle());
}

}  // namespace
}  // namespace uplink::journal
