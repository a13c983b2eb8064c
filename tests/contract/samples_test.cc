#include <gmock/gmock.h>

#include "schema/uncrew/judge.h"
#include "schema/uncrew/records.h"
#include "storage/bounds.h"
#include "storage/refusal.h"
#include "tests/contract/claim_contract.h"
#include "uncrew/v1/avatar.pb.h"

/// What a store decides for drones' samples, and remembers of them.
namespace uplink::testing {
namespace {

using model::uncrew::SampleType;
using storage::OutcomeKind;
using storage::SampleMemory;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SamplesContract : public ClaimContract {
 protected:
  SamplesContract() { Claim(); }

  OutcomeKind CommitOne(const storage::SampleMark& mark) {
    const auto outcomes = Commit(Sample(mark));
    return outcomes.size() == 1 ? outcomes[0] : OutcomeKind::kFenced;
  }
  std::vector<SampleMemory> Memory() { return Claim().samples; }
};

TEST_P(SamplesContract, KnowsASampleThatIsSentAgain) {
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kStored);
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kDuplicate);
  store_->Reopen();
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kDuplicate);
  EXPECT_THAT(Messages(), SizeIs(1));
}

TEST_P(SamplesContract, KnowsASampleWhoseAnswerWasLost) {
  storage::Batch batch;
  batch.records = Sample(Mark(1));
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(KindsOf(Commit(batch)), ElementsAre(OutcomeKind::kDuplicate));
  store_->FailNextWrite(kProcess);
  batch.records = Sample(Mark(2));
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(KindsOf(Commit(batch)), ElementsAre(OutcomeKind::kStored)) << "nothing was kept";
  EXPECT_THAT(Messages(), SizeIs(2));
}

TEST_P(SamplesContract, KeepsTheSourcesLevelOfAStatusText) {
  ::uncrew::v1::PublishStatusTextRequest request;
  request.mutable_status_text()->set_text("low wind");
  request.mutable_status_text()->set_type(::uncrew::v1::STATUS_TEXT_TYPE_NOTICE);
  auto made = uncrew::Records::Of(
      uncrew::Judge(SampleType::kStatusText, request.SerializeAsString()), nullptr);
  ASSERT_THAT(made, SizeIs(1));
  Commit(Sample(Mark(1), {std::get<model::Record>(made[0])}));
  ASSERT_THAT(Messages(), SizeIs(1));
  EXPECT_EQ(Messages()[0].message.level, model::MessageLevel::kInfo);
  EXPECT_EQ(Messages()[0].message.source_level, "notice");
}

TEST_P(SamplesContract, AnswersWhetherAClaimHoldsAndWritesNothing) {
  const auto question = [this] {
    return Sample(storage::SampleMark{.claim = claim_, .is_question = true});
  };
  EXPECT_THAT(Commit(question()), ElementsAre(OutcomeKind::kDuplicate));
  EXPECT_THAT(Commit(Join(Sample(Mark(1)), question())),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kDuplicate));
  EXPECT_THAT(Messages(), SizeIs(1));
  EXPECT_THAT(Memory(), SizeIs(1)) << "of the sample alone";
  const auto before = question();
  Claim();
  EXPECT_THAT(Commit(before), ElementsAre(OutcomeKind::kFenced));
}

TEST_P(SamplesContract, KnowsTheSecondCopyWithinABatch) {
  EXPECT_THAT(Commit(Join(Sample(Mark(1)), Sample(Mark(1)))),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kDuplicate));
}

TEST_P(SamplesContract, RemembersTheLastWithTimes) {
  std::vector<storage::CommitRecord> records;
  for (std::uint8_t content = 0; content <= storage::kSamplesKept; ++content) {
    records = Join(std::move(records), Sample(Mark(content)));
  }
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kStored));
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kDuplicate) << "the oldest that is kept";
  EXPECT_EQ(CommitOne(Mark(storage::kSamplesKept)), OutcomeKind::kDuplicate);
  EXPECT_EQ(CommitOne(Mark(0)), OutcomeKind::kStored) << "one older";
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kStored) << "which moved the next out";
  EXPECT_THAT(Memory()[0].digests, SizeIs(storage::kSamplesKept));
}

TEST_P(SamplesContract, RemembersTheLastAloneWithoutTimes) {
  EXPECT_EQ(CommitOne(Untimed(Mark(1))), OutcomeKind::kStored);
  EXPECT_EQ(CommitOne(Untimed(Mark(1))), OutcomeKind::kDuplicate);
  EXPECT_EQ(CommitOne(Untimed(Mark(2))), OutcomeKind::kStored);
  EXPECT_EQ(CommitOne(Untimed(Mark(1))), OutcomeKind::kStored);
}

TEST_P(SamplesContract, KeepsTypesAndDronesApart) {
  EXPECT_EQ(CommitOne(Mark(1, 0)), OutcomeKind::kStored);
  EXPECT_EQ(CommitOne(Mark(1, storage::kSampleTypesMax - 1)), OutcomeKind::kStored);
  const storage::ClaimResult other = ClaimEach({{Robot("b"), Time()}}).front();
  storage::SampleMark mark = Mark(1, 0);
  mark.claim = other.claim;
  std::vector<storage::CommitRecord> records = Sample(mark);
  records[0].robot = Robot("b");
  EXPECT_THAT(Commit(records), ElementsAre(OutcomeKind::kStored));
  const std::vector<SampleMemory> memory = Memory();
  ASSERT_THAT(memory, SizeIs(2));
  EXPECT_EQ(memory[0].type, 0U);
  EXPECT_EQ(memory[1].type, storage::kSampleTypesMax - 1);
}

TEST_P(SamplesContract, GivesBackWhatWasSaidWithTheLast) {
  storage::SampleMark mark = Mark(1);
  mark.last = std::string("\0first", 6);
  EXPECT_EQ(CommitOne(mark), OutcomeKind::kStored);
  EXPECT_THAT(Memory(), ElementsAre(SampleMemory{1, {Mark(1).digest}, mark.last}));
  storage::SampleMark next = Mark(2);
  next.last = std::string(storage::kSampleLastBytesMax, '\xFF');
  EXPECT_EQ(CommitOne(next), OutcomeKind::kStored);
  EXPECT_THAT(Memory(), ElementsAre(SampleMemory{1, {Mark(1).digest, Mark(2).digest}, next.last}));
  EXPECT_EQ(CommitOne(Mark(3)), OutcomeKind::kStored);
  EXPECT_EQ(Memory()[0].last, "");
}

TEST_P(SamplesContract, DecidesAllRecordsOfASampleAlike) {
  const auto records = [this] {
    return Sample(Mark(1), {Durable(Fault("f1")), Durable(Fault("f2")), Durable(Note())});
  };
  EXPECT_THAT(Commit(records()), Each(OutcomeKind::kStored));
  EXPECT_THAT(Commit(records()), ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kDuplicate,
                                             OutcomeKind::kDuplicate));
  claim_ = 1'000'000;
  EXPECT_THAT(Commit(records()), Each(OutcomeKind::kFenced));
  EXPECT_THAT(Active(), SizeIs(2));
  EXPECT_THAT(History(), SizeIs(2));
}

TEST_P(SamplesContract, RemembersARejectedSample) {
  const auto rejected = [this] {
    return Sample(Mark(1, 0), {storage::QuarantineItem{BadReason()}});
  };
  EXPECT_THAT(Commit(rejected()), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(Commit(rejected()), ElementsAre(OutcomeKind::kDuplicate));
  ASSERT_THAT(Quarantine(), SizeIs(1));
  EXPECT_EQ(Quarantine()[0].source, model::MessageSource::kUncrew);
  EXPECT_EQ(Quarantine()[0].rejection, BadReason());
}

TEST_P(SamplesContract, StandsBesideOtherRobotsInABatch) {
  OpenAlso({Robot("b")});
  std::vector<storage::CommitRecord> records = Sample(Mark(1));
  records.insert(records.begin(), Of(Robot("b"), Good(1)));
  records.push_back(Of(Robot("b"), Good(2)));
  records[0].held_since = records[2].held_since = also_held_[Robot("b")->ruri];
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kStored));
  records = Join({records[2]}, Sample(Mark(1)));
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kDuplicate));
}

TEST_P(SamplesContract, HasNoCursor) {
  EXPECT_THAT(Commit(Sample(Mark(1), {Durable(Note()), Durable(Note())})),
              Each(OutcomeKind::kStored));
  number_ = 0;
  EXPECT_EQ(CommitOne(Mark(2)), OutcomeKind::kStored) << "a number that was used";
  storage::OpenRequest request = Request();
  request.session = Session(77);
  EXPECT_EQ(Open(request).cursor, 0U);
}

TEST_P(SamplesContract, SetsAsideTheRecordThatTheDatabaseRefusesAlone) {
  store_->RefuseFault("f2");
  const auto records = [this] {
    return Join(Sample(Mark(1)),
                Sample(Mark(2), {Durable(Fault("f1")), Durable(Fault("f2")), Durable(Fault("f3")),
                                 Durable(Note()), Durable(Note())}));
  };
  EXPECT_THAT(Commit(records()),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kRefused,
                          OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kStored));
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(Active(), SizeIs(2));
  EXPECT_THAT(Commit(records()), Each(OutcomeKind::kDuplicate));
  EXPECT_THAT(Messages(), SizeIs(3));
}

TEST_P(SamplesContract, CountAgainstTheBoundsOfARobotThatAnotherProcessHolds) {
  const storage::Epoch claim = claim_;
  Open(Request(), kOther);
  std::vector<storage::CommitRecord> faults;
  for (model::Seq seq = 1; seq < storage::kActiveFaultsPerRobotMax; ++seq) {
    faults.push_back(Good(seq, Fault("f" + std::to_string(seq))));
    if (faults.size() == 1'000) Commit(std::exchange(faults, {}), kOther);
  }
  Commit(faults, kOther);
  claim_ = claim;
  EXPECT_THAT(
      Commit(Sample(Mark(1), {Durable(Fault("g1")), Durable(Fault("g2")), Durable(Fault("f1")),
                              Durable(Cleared("f2")), Durable(Fault("g3"))})),
      ElementsAre(OutcomeKind::kStored, OutcomeKind::kRefused, OutcomeKind::kStored,
                  OutcomeKind::kStored, OutcomeKind::kStored));
  ASSERT_THAT(Quarantine(), SizeIs(1));
  EXPECT_EQ(Quarantine()[0].rejection, storage::TooManyActiveFaults());
  EXPECT_THAT(Commit({Good(storage::kActiveFaultsPerRobotMax, Fault("h"))}, kOther),
              ElementsAre(OutcomeKind::kRefused))
      << "and those of the drone count for its stream";
}

TEST_P(SamplesContract, GoWithTheirRobot) {
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kStored);
  store_->RemoveRobot(robot_->ruri);
  EXPECT_EQ(CommitOne(Mark(2)), OutcomeKind::kFenced);
  EXPECT_THAT(Memory(), IsEmpty());
  EXPECT_EQ(CommitOne(Mark(1)), OutcomeKind::kStored);
}

INSTANTIATE_TEST_SUITE_P(Stores, SamplesContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
