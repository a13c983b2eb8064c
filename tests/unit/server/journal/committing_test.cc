#include "server/journal/committing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/schema/samples.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class CommittingTest : public ::testing::Test, protected StepBench {
 protected:
  CommittingTest() : StepBench({.records_max = 4}) { Hold(robot_); }

  void Commit() {
    ASSERT_TRUE(committing_.Gather());
    ASSERT_EQ(committing_.Commit(), Step::kWorked);
  }
  void Fail(int times) {
    store.FailNextCommits(static_cast<std::uint32_t>(times), FailAt::kBefore);
    for (int i = 0; i < times; ++i) EXPECT_EQ(committing_.Commit(), Step::kFailed);
  }

  /// A report of a run of its own, which is open.
  [[nodiscard]] storage::CommitRecord RunOf(model::Seq seq) const {
    model::MissionRunStatus report = test::SampleMission();
    report.run_id = std::to_string(seq);
    report.status = model::MissionStatus::kRunning;
    storage::CommitRecord record = RecordOf(robot_, seq);
    record.content = test::RecordOf(report);
    return record;
  }

  CountingInbox wakes_;
  RecordingClient robot_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  Committing committing_{
      context(), holds, {.records_max = 8, .bytes_max = 1'000'000}, model::SessionId()};
};

TEST_F(CommittingTest, TellsOfShapesAndObjectsOnceTheyAreTold) {
  Append(robot_, 1);
  Commit();
  committing_.Tell();
  EXPECT_EQ(spatial_commits, 0) << "a fault is none";
  storage::CommitRecord shape = RecordOf(robot_, 2);
  shape.content = test::RecordOf(model::ShapeOp{model::Deletion{"gone"}});
  inbox.AppendMessage(robot_, robot_.generation(), {shape}, clock.Steady());
  Commit();
  EXPECT_EQ(spatial_commits, 0);
  committing_.Tell();
  EXPECT_EQ(spatial_commits, 1);
}

/// Each look at it is a step later.
class SteppingClock final : public Clock {
 public:
  explicit SteppingClock(milliseconds step) : step_(step) {}
  [[nodiscard]] SteadyTime Steady() const override { return now_ += step_; }
  [[nodiscard]] SystemTime System() const override { return {}; }

 private:
  const milliseconds step_;
  mutable SteadyTime now_;
};

TEST_F(CommittingTest, TellsOfCommitsThatTakeAsLongAsASlowOne) {
  for (const milliseconds took : {kSlowCommit - milliseconds(1), kSlowCommit}) {
    const SteppingClock by(took);
    Committing committing(context(by), holds, {.records_max = 8, .bytes_max = 1'000'000},
                          model::SessionId());
    Append(robot_, static_cast<model::Seq>(took.count()));
    ASSERT_TRUE(committing.Gather());
    ASSERT_EQ(committing.Commit(), Step::kWorked);
    committing.Tell();
  }
  ASSERT_THAT(slow_commits, SizeIs(1));
  EXPECT_EQ(slow_commits[0].records, 1U);
  EXPECT_EQ(slow_commits[0].took, kSlowCommit);
}

TEST_F(CommittingTest, HasNothingToCommit) {
  EXPECT_FALSE(committing_.Gather());
  EXPECT_FALSE(committing_.HasBatch());
  EXPECT_FALSE(committing_.HasOutcomes());
}

TEST_F(CommittingTest, GoesFromABatchToOutcomesToNothing) {
  Append(robot_, 1);
  EXPECT_TRUE(committing_.Gather());
  EXPECT_TRUE(committing_.HasBatch());
  EXPECT_FALSE(committing_.HasOutcomes());
  EXPECT_EQ(committing_.Commit(), Step::kWorked);
  EXPECT_TRUE(committing_.HasOutcomes());
  EXPECT_THAT(Stored(robot_), ElementsAre(1));
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_EQ(wakes_.wakes(1), 0);
  EXPECT_FALSE(inbox.idle());
  committing_.Tell();
  EXPECT_FALSE(committing_.HasOutcomes());
  EXPECT_FALSE(committing_.HasBatch());
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(CommittingTest, CountsRunsThatTheStoreClosedForTheirBound) {
  storage::Batch batch;
  for (model::Seq seq = 1; seq <= storage::kOpenRunsPerRobotMax; ++seq) {
    batch.records.push_back(RunOf(seq));
    batch.records.back().held_since = 1;
  }
  ASSERT_TRUE(store.Commit(batch).ok());
  inbox.AppendMessage(robot_, robot_.generation(), {RunOf(storage::kOpenRunsPerRobotMax + 1)},
                      clock.Steady());
  Commit();
  EXPECT_EQ(probe.runs_closed_for_bound.value(), 1);
}

TEST_F(CommittingTest, ABatchTakesNothingThatComesAfterIt) {
  Append(robot_, 1);
  EXPECT_TRUE(committing_.Gather());
  Append(robot_, 2);
  EXPECT_TRUE(committing_.Gather());
  EXPECT_EQ(committing_.Commit(), Step::kWorked);
  EXPECT_THAT(Stored(robot_), ElementsAre(1));
}

TEST_F(CommittingTest, TellingMakesRoomBeforeItWakes) {
  const loop::StreamRef waiter{.inbox = &wakes_, .stream = 9};
  for (model::Seq seq = 1; seq <= 4; ++seq) Append(robot_, seq);
  inbox.WhenRoom(waiter);
  Commit();
  EXPECT_EQ(wakes_.wakes(9), 0) << "what is committed and not told still counts";
  committing_.Tell();
  EXPECT_EQ(wakes_.wakes(9), 1);
  EXPECT_EQ(inbox.bytes(), 0U);
}

TEST_F(CommittingTest, ChangesOfPresenceAreDoneWithTheCommit) {
  inbox.NotePresence(robot_.robot(), model::Presence::kOnline, clock.System());
  Commit();
  EXPECT_TRUE(inbox.idle()) << "no client hears of them";
  EXPECT_EQ(probe.presence_changes[1].value(), 1);
  EXPECT_TRUE(committing_.HasOutcomes());
  committing_.Tell();
  EXPECT_THAT(robot_.Told(), IsEmpty());
}

TEST_F(CommittingTest, ARefusedChangeOfPresenceEndsTheHold) {
  database.DeleteRobotRow(robot_.robot()->ruri);
  inbox.NotePresence(robot_.robot(), model::Presence::kOnline, clock.System());
  Commit();
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced")) << "its stream opens it anew";
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_EQ(probe.presence_refused.value(), 1);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(CommittingTest, ARefusedChangeOfAnEarlierHoldEndsNothing) {
  inbox.NotePresence(robot_.robot(), model::Presence::kOnline, clock.System());
  ASSERT_TRUE(committing_.Gather());
  database.DeleteRobotRow(robot_.robot()->ruri);
  Hold(robot_);
  const storage::Epoch since = holds.robots().Since(robot_);
  static_cast<void>(robot_.Told());
  ASSERT_EQ(committing_.Commit(), Step::kWorked);
  EXPECT_EQ(probe.presence_refused.value(), 1);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_EQ(holds.robots().Since(robot_), since);
}

TEST_F(CommittingTest, WhatBecameVoidIsDroppedAndMakesRoom) {
  Append(robot_, 1);
  AppendGap(robot_, 2);
  EXPECT_TRUE(committing_.Gather());
  static_cast<void>(robot_.OnFenced(ledger));
  static_cast<void>(robot_.Told());
  EXPECT_EQ(committing_.Commit(), Step::kWorked);
  EXPECT_THAT(Stored(robot_), IsEmpty());
  EXPECT_EQ(inbox.records(), 0U);
  EXPECT_EQ(inbox.bytes(), 0U);
  EXPECT_EQ(inbox.oldest(clock.Steady() + milliseconds(5)), milliseconds(0));
  EXPECT_THAT(robot_.Told(), ElementsAre("gaps 1")) << "its next stream may be held back for them";
  EXPECT_EQ(wakes_.wakes(1), 1);
}

TEST_F(CommittingTest, AFailedBatchIsTriedAgainAsItWas) {
  Append(robot_, 1);
  EXPECT_TRUE(committing_.Gather());
  store.FailNextCommits(1, FailAt::kAfter);
  EXPECT_EQ(committing_.Commit(), Step::kFailed);
  EXPECT_FALSE(errors.last().ok());
  EXPECT_TRUE(committing_.HasBatch());
  Append(robot_, 2);
  Commit();
  committing_.Tell();
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1")) << "its own earlier try stored it";
  EXPECT_TRUE(errors.last().ok());
}

TEST_F(CommittingTest, AfterFailuresTheLaterHalfGoesBackAndComesNext) {
  for (model::Seq seq = 1; seq <= 5; ++seq) Append(robot_, seq);
  EXPECT_TRUE(committing_.Gather());
  Fail(kFailuresToHalve);
  EXPECT_EQ(inbox.records(), 5U);
  Append(robot_, 6);
  Commit();
  committing_.Tell();
  Commit();
  committing_.Tell();
  EXPECT_THAT(robot_.Told(), ElementsAre("settled 1 2", "settled 3 4"));
  EXPECT_THAT(inbox.records(), 2U);
}

TEST_F(CommittingTest, ManySuccessesDoubleTheBatchAgain) {
  for (model::Seq seq = 1; seq <= 2; ++seq) Append(robot_, seq);
  EXPECT_TRUE(committing_.Gather());
  Fail(kFailuresToHalve);
  for (model::Seq seq = 3; seq <= kSuccessesToDouble + 2; ++seq) Append(robot_, seq);
  for (int i = 0; i < kSuccessesToDouble; ++i) {
    Commit();
    committing_.Tell();
  }
  EXPECT_THAT(robot_.Told(), SizeIs(kSuccessesToDouble)) << "one by one";
  Commit();
  committing_.Tell();
  EXPECT_THAT(robot_.Told(), ElementsAre("settled " + std::to_string(kSuccessesToDouble + 1) + " " +
                                         std::to_string(kSuccessesToDouble + 2)));
}

}  // namespace
}  // namespace uplink::journal
