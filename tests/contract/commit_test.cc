#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::Outcome;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST_P(StoreContract, KeepsEveryFieldOfAFault) {
  Open();
  model::Fault fault = Fault("f");
  fault.severity = static_cast<model::FaultSeverity>(77);
  Commit({Good(1, fault)});
  const auto rows = History();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].fault, fault);
  EXPECT_EQ(rows[0].robot, *robot_);
  EXPECT_EQ(rows[0].received_at, Time());
  EXPECT_FALSE(rows[0].raised_at.has_value());
}

TEST_P(StoreContract, TakesTheSecondCopyWithinABatchForADuplicate) {
  Open();
  EXPECT_THAT(Commit({Good(1, Fault("f")), Good(1, Fault("f")), Good(2)}),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kDuplicate, OutcomeKind::kStored));
  EXPECT_THAT(History(), SizeIs(1));
}

TEST_P(StoreContract, NeverLowersTheCursor) {
  Open();
  Commit({Good(9)});
  EXPECT_THAT(Commit({Good(4, Fault("f"))}), ElementsAre(OutcomeKind::kDuplicate));
  EXPECT_EQ(CursorNow(), 9);
  EXPECT_THAT(History(), SizeIs(0));
}

TEST_P(StoreContract, StoresANumberOnceThoughItIsSentAgainAfterMidnight) {
  Open();
  storage::CommitRecord record = Good(1, Fault("f"));
  record.received_at = Time(-1);
  Commit({record});
  record.received_at = Time(86'400'000);
  EXPECT_THAT(Commit({record, At(86'400'000, Good(2))}),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kStored));
  EXPECT_THAT(History(), SizeIs(1));
}

TEST_P(StoreContract, KeepsAllOfACommitWhoseAnswerIsLost) {
  Open();
  const std::vector<storage::CommitRecord> records = {Good(1, Fault("f")), Good(2)};
  storage::Batch batch;
  batch.records = records;
  store_->LoseNextAnswer(kProcess);
  EXPECT_EQ(store_->Process(kProcess).Commit(batch).status().code(),
            absl::StatusCode::kUnavailable);
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kDuplicate));
  EXPECT_THAT(History(), SizeIs(1));
}

TEST_P(StoreContract, KeepsACursorForEachRobotAndSession) {
  Open();
  storage::CommitRecord other_session = Good(5);
  other_session.session = Session(2);
  OpenAlso({Robot("b")});
  storage::CommitRecord other_robot = Good(3);
  other_robot.robot = Robot("b");
  EXPECT_THAT(Commit({Good(9), other_session, other_robot}), Each(OutcomeKind::kStored));
  EXPECT_EQ(CursorNow(), 9);
  storage::OpenRequest request = Request();
  request.session = Session(2);
  EXPECT_EQ(Open(request).cursor, 5);
  request = Request();
  request.robot = Robot("b");
  EXPECT_EQ(Open(request).cursor, 3);
}

TEST_P(StoreContract, TakesTheHighestNumberOfTheContract) {
  Open();
  EXPECT_THAT(Commit({Good(model::kSeqMax - 1, Fault("f")), Bad(model::kSeqMax)}),
              Each(OutcomeKind::kStored));
  EXPECT_THAT(Commit({Good(model::kSeqMax - 1), Bad(model::kSeqMax)}),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kRefused));
  storage::OpenRequest request = Request();
  request.settled_seq = model::kSeqMax - 1;
  const storage::OpenResult result = Open(request);
  EXPECT_EQ(result.cursor, model::kSeqMax);
  ASSERT_THAT(result.rejects, SizeIs(1));
  EXPECT_EQ(result.rejects[0].seq, model::kSeqMax);
  request.settled_seq = model::kSeqMax;
  EXPECT_THAT(Open(request).rejects, SizeIs(0));
}

TEST_P(StoreContract, TakesANumberZeroForADuplicate) {
  Open();
  EXPECT_THAT(Commit({Good(0)}), ElementsAre(OutcomeKind::kDuplicate));
}

TEST_P(StoreContract, TakesAnEmptyBatch) { EXPECT_THAT(Commit(storage::Batch()), SizeIs(0)); }

TEST_P(StoreContract, TakesABatchOfTenThousand) {
  Open();
  std::vector<storage::CommitRecord> records;
  const model::Record good = test::RecordOf(Fault("f"));
  for (model::Seq seq = 1; seq <= 10'000; ++seq) records.push_back(With(seq, good));
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kStored));
  EXPECT_EQ(CursorNow(), 10'000);
  storage::HistoryQuery query;
  query.page_size = storage::kPageSizeMax;
  EXPECT_THAT(History(query), SizeIs(storage::kPageSizeMax));
}

TEST_P(StoreContract, FencesWhatIsCommittedForARobotThatHasNoRow) {
  held_since_ = 40;
  storage::Batch batch;
  batch.records = {Good(3, Fault("f")), Bad(4)};
  batch.gaps = {Gap(1, 2)};
  EXPECT_THAT(KindsOf(Commit(batch)), Each(OutcomeKind::kFenced));
  EXPECT_EQ(*store_->reader().RobotCount(), 0U) << "a batch makes no robot";
  const storage::OpenResult result = Open();
  EXPECT_FALSE(result.was_known);
  EXPECT_EQ(result.cursor, 0);
  EXPECT_THAT(result.rejects, SizeIs(0));
  EXPECT_THAT(History(), SizeIs(0));
  EXPECT_THAT(Active(), SizeIs(0));
  EXPECT_THAT(Quarantine(), SizeIs(0));
  EXPECT_THAT(Gaps(), SizeIs(0));
}

TEST_P(StoreContract, FencesALaterHoldThanTheRowsAndTakesTheRowsInOneBatch) {
  Open();
  const storage::Epoch hold = held_since_;
  // Of a store that went back: what was given later than its rows know of.
  held_since_ = hold + 7;
  storage::CommitRecord later = Good(1, Fault("f"));
  storage::CommitRecord later_too = Bad(3);
  const storage::GapItem later_gap = Gap(4, 5);
  held_since_ = hold;
  storage::Batch batch;
  batch.records = {later, Good(2, Fault("g")), later_too};
  batch.gaps = {later_gap, Gap(6, 6)};
  batch.presence_session = Session(9);
  batch.presence = {{robot_, model::Presence::kOffline, Time(), 1, hold + 7},
                    {robot_, model::Presence::kOnline, Time(), 2, hold}};
  std::vector<OutcomeKind> kinds;
  for (const Outcome& outcome : Commit(batch)) kinds.push_back(outcome.kind);
  EXPECT_THAT(kinds, ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored, OutcomeKind::kFenced,
                                 OutcomeKind::kFenced, OutcomeKind::kStored));
  EXPECT_EQ(CursorNow(), 2);
  ASSERT_THAT(Gaps(), SizeIs(1));
  EXPECT_EQ(Gaps().front().first, 6);
  EXPECT_THAT(Changes(), SizeIs(1));
}

TEST_P(StoreContract, FencesAnotherProcessWithTheSameHold) {
  Open();
  // Two processes are given one epoch by a store that went back between.
  EXPECT_THAT(Commit({Good(1, Fault("f"))}, kOther), ElementsAre(OutcomeKind::kFenced));
  storage::Batch batch;
  batch.gaps = {Gap(1, 2)};
  batch.presence_session = Session(9);
  batch.presence = {{robot_, model::Presence::kOffline, Time(), 1, held_since_}};
  EXPECT_EQ(Commit(batch, kOther).at(0).kind, OutcomeKind::kFenced);
  EXPECT_THAT(Gaps(), SizeIs(0));
  EXPECT_THAT(Commit({Good(1, Fault("f"))}), ElementsAre(OutcomeKind::kStored));
}

TEST_P(StoreContract, FencesWhatIsCommittedForARobotWhoseRowWent) {
  Open();
  Commit({Good(1, Fault("f"))});
  storage::OpenRequest of_other_robot = Request();
  of_other_robot.robot = Robot("b");
  const storage::Epoch hold = held_since_;
  const storage::Epoch hold_of_other = Open(of_other_robot).held_since;
  held_since_ = hold;
  store_->DeleteRobotRow(robot_->ruri);
  storage::CommitRecord other = Of(Robot("b"), Good(1, Fault("f")));
  other.held_since = hold_of_other;
  // Of what it has already, and of what is new; the rest of the batch goes on.
  EXPECT_THAT(Commit({Good(1, Fault("f")), other, Good(2, Fault("g"))}),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored, OutcomeKind::kFenced));
  CommitGaps({Gap(3, 4)});
  EXPECT_THAT(Gaps(), SizeIs(0));
  EXPECT_THAT(History(), SizeIs(2));
  EXPECT_EQ(*store_->reader().RobotCount(), 1U);
  const storage::OpenResult result = Open();
  EXPECT_GT(result.held_since, hold);
  EXPECT_EQ(result.cursor, 1) << "its session stayed";
  EXPECT_THAT(Commit({Good(1, Fault("f")), Good(2, Fault("g"))}),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kStored));
}

}  // namespace
}  // namespace uplink::testing
