#include <gmock/gmock.h>

#include "tests/contract/claim_contract.h"

/// Which process serves a drone's calls, and whether it holds the robot.
namespace uplink::testing {
namespace {

using model::Presence;
using storage::ClaimResult;
using storage::FleetWord;
using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ClaimsContract : public ClaimContract {
 protected:
  /// False for a store that one process has at a time: a claim always takes the robot there.
  bool Renew(std::uint8_t process) {
    storage::Leases* const leases = store_->LeasesOf(process);
    if (leases == nullptr) return false;
    EXPECT_TRUE(leases->Renew({.name = "a", .life = "1"}).ok());
    return true;
  }
  /// As the holder says it.
  void Say(Presence presence, std::int64_t after_ms, std::uint8_t process = kProcess) {
    storage::Batch batch;
    batch.presence = {{robot_, presence, Time(after_ms), ++said_, held_since_}};
    batch.presence_session = Session(99);
    EXPECT_THAT(KindsOf(Commit(batch, process)), ElementsAre(OutcomeKind::kStored));
  }
  storage::OpenResult OpenAt(std::int64_t after_ms, std::uint8_t process = kProcess) {
    storage::OpenRequest request = Request();
    request.at = Time(after_ms);
    return Open(request, process);
  }
  std::vector<storage::RobotRow> Robots() {
    auto robots = store_->reader().Robots(10);
    EXPECT_TRUE(robots.ok()) << robots.status();
    return robots.ok() ? *std::move(robots) : std::vector<storage::RobotRow>();
  }

  model::Seq said_ = 0;
};

TEST_P(ClaimsContract, MakesTheRobotAndHoldsItWithoutASession) {
  const ClaimResult claimed = Claim();
  EXPECT_FALSE(claimed.was_known);
  EXPECT_GT(claimed.claim, 0U);
  EXPECT_GT(claimed.held_since, 0U);
  EXPECT_THAT(claimed.samples, IsEmpty());
  EXPECT_EQ(claimed.presence, std::nullopt);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
  ASSERT_THAT(Robots(), SizeIs(1));
  EXPECT_EQ(Robots()[0].robot, *robot_);
  EXPECT_EQ(Robots()[0].holder, storage::ProcessId{kProcess});
  EXPECT_TRUE(Robots()[0].was_claimed);
  EXPECT_FALSE(Robots()[0].last_session.has_value()) << "a sample has no cursor";
  EXPECT_THAT(ClaimEach({}), IsEmpty());
}

TEST_P(ClaimsContract, IsHeardWhenASampleIsStored) {
  Claim();
  EXPECT_EQ(Robots()[0].last_seen, Time());
  std::vector<storage::CommitRecord> records = Sample(Mark(1));
  records[0].received_at = Time(9);
  Commit(records);
  EXPECT_EQ(Robots()[0].last_seen, Time(9));
  Claim(kProcess, 20);
  EXPECT_EQ(Robots()[0].last_seen, Time(20));
  EXPECT_EQ(Robots()[0].first_seen, Time());
}

TEST_P(ClaimsContract, GoesOnWithTheHoldOfItsOwnProcess) {
  const storage::OpenResult opened = Open();
  const ClaimResult claimed = Claim();
  EXPECT_TRUE(claimed.was_known);
  EXPECT_EQ(claimed.held_since, opened.held_since);
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kStored)) << "the stream goes on";
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
  EXPECT_EQ(CursorNow(), 1U);
  EXPECT_EQ(Open().held_since, opened.held_since);
  EXPECT_THAT(Commit(Sample(Mark(2))), ElementsAre(OutcomeKind::kStored))
      << "a stream leaves the claim as it is";
}

TEST_P(ClaimsContract, AlternatesBetweenProcessesAndLosesAndDoublesNothing) {
  Claim();
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
  const storage::Epoch first = claim_;
  const ClaimResult other = Claim(kOther);
  EXPECT_GT(other.claim, first);
  ASSERT_THAT(other.samples, SizeIs(1));
  EXPECT_THAT(other.samples[0].digests, ElementsAre(Mark(1).digest));
  EXPECT_THAT(Commit(Sample(Mark(1)), kOther), ElementsAre(OutcomeKind::kDuplicate));
  EXPECT_THAT(Commit(Sample(Mark(2)), kOther), ElementsAre(OutcomeKind::kStored));
  claim_ = first;
  EXPECT_THAT(Commit(Sample(Mark(3))), ElementsAre(OutcomeKind::kFenced));
  EXPECT_THAT(Commit(Sample(Mark(2))), ElementsAre(OutcomeKind::kFenced)) << "a duplicate too";
  EXPECT_THAT(Claim().samples[0].digests, ElementsAre(Mark(1).digest, Mark(2).digest));
  EXPECT_THAT(Commit(Sample(Mark(3))), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(Messages(), SizeIs(3));
}

TEST_P(ClaimsContract, FencesTheEarlierClaimOfItsOwnProcess) {
  Claim();
  const storage::Epoch first = claim_;
  EXPECT_GT(Claim().claim, first);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
  claim_ = first;
  EXPECT_THAT(Commit(Sample(Mark(2))), ElementsAre(OutcomeKind::kFenced));
}

TEST_P(ClaimsContract, FencesWhatIsNotClaimed) {
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kFenced)) << "there is no robot";
  Open();
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kFenced)) << "a hold is no claim";
  Claim();
  EXPECT_THAT(Commit(Sample(Mark(1)), kOther), ElementsAre(OutcomeKind::kFenced)) << "another's";
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kFenced)) << "its row is gone";
  EXPECT_EQ(*store_->reader().RobotCount(), 0U);
  EXPECT_FALSE(Claim().was_known);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
}

TEST_P(ClaimsContract, KeepsNothingOfAClaimThatFailed) {
  store_->FailNextWrite(kProcess);
  const storage::ClaimRequest request = Asked();
  EXPECT_FALSE(store_->Process(kProcess).ClaimDrones({&request, 1}).ok());
  EXPECT_EQ(*store_->reader().RobotCount(), 0U);
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).ClaimDrones({&request, 1}).ok());
  EXPECT_TRUE(Claim().was_known);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
}

TEST_P(ClaimsContract, LeavesTheRobotToAProcessThatHasALease) {
  const bool shared = Renew(kOther);
  const storage::OpenResult opened = OpenAt(0, kOther);
  const ClaimResult claimed = Claim();
  EXPECT_GT(claimed.claim, 0U);
  EXPECT_TRUE(claimed.was_known);
  EXPECT_EQ(claimed.held_since == 0, shared);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored)) << "all the same";
  EXPECT_THAT(Commit({Good(1)}, kOther),
              ElementsAre(shared ? OutcomeKind::kStored : OutcomeKind::kFenced));
  EXPECT_EQ(OpenAt(1, kOther).held_since == opened.held_since, shared);
  EXPECT_THAT(Commit(Sample(Mark(2))), ElementsAre(OutcomeKind::kStored))
      << "a stream that opens leaves the claim as it is";
  EXPECT_THAT(Messages(), SizeIs(shared ? 3 : 2));
}

TEST_P(ClaimsContract, TakesTheRobotOfAProcessWithoutALease) {
  OpenAt(0, kOther);
  EXPECT_GT(Claim().held_since, held_since_);
  EXPECT_THAT(Commit({Good(1)}, kOther), ElementsAre(OutcomeKind::kFenced));
}

TEST_P(ClaimsContract, TakesTheRobotOfAProcessThatReleasedItsLease) {
  if (!Renew(kOther)) return;
  OpenAt(0, kOther);
  EXPECT_EQ(Claim().held_since, 0U);
  ASSERT_TRUE(store_->LeasesOf(kOther)->Release().ok());
  EXPECT_GT(Claim().held_since, held_since_);
}

TEST_P(ClaimsContract, TakesARobotThatIsOffline) {
  if (!Renew(kOther)) return;
  OpenAt(0, kOther);
  Say(Presence::kOnline, 1, kOther);
  EXPECT_EQ(Claim(kProcess, 2).held_since, 0U);
  Say(Presence::kOffline, 3, kOther);
  const ClaimResult claimed = Claim(kProcess, 4);
  EXPECT_GT(claimed.held_since, held_since_);
  EXPECT_EQ(claimed.presence, (storage::StoredPresence{Presence::kOffline, Time(3)}));
}

TEST_P(ClaimsContract, LeavesARobotThatOpenedAStreamSinceItWasOffline) {
  if (!Renew(kOther)) return;
  OpenAt(0, kOther);
  Say(Presence::kOffline, 3, kOther);
  OpenAt(4, kOther);
  EXPECT_EQ(Claim(kProcess, 5).held_since, 0U) << "that it is online is not committed yet";
  EXPECT_THAT(Commit({Good(1)}, kOther), ElementsAre(OutcomeKind::kStored));
}

TEST_P(ClaimsContract, LeavesARobotThatAnotherClaimTookSinceItWasOffline) {
  if (!Renew(kProcess) || !Renew(kOther)) return;
  OpenAt(0, kOther);
  Say(Presence::kOffline, 3, kOther);
  EXPECT_GT(Claim(kProcess, 4).held_since, 0U);
  EXPECT_EQ(Claim(kOther, 5).held_since, 0U);
}

TEST_P(ClaimsContract, GivesTheRobotToAStreamThatOpensElsewhere) {
  if (!Renew(kProcess)) return;
  const storage::Epoch held = Claim().held_since;
  EXPECT_GT(OpenAt(1, kOther).held_since, held);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored));
}

TEST_P(ClaimsContract, MovesARobotByTheWordOfItsCertificate) {
  Claim();
  const storage::RobotRef moved = Robot("a", "f2");
  const ClaimResult claimed = ClaimEach({{moved, Time(1), FleetWord::kMoves}}).front();
  EXPECT_EQ(claimed.moved_from, "f1");
  EXPECT_EQ(claimed.other_fleet, std::nullopt);
  EXPECT_GT(claimed.claim, claim_);
  EXPECT_EQ(Robots()[0].robot.fleet, "f2");
}

TEST_P(ClaimsContract, WritesNothingOfARobotOfAnotherFleetThanTheGateways) {
  Claim();
  const storage::RobotRef other = Robot("a", "f2");
  const ClaimResult refused = ClaimEach({{other, Time(1), FleetWord::kMatches}}, kOther).front();
  EXPECT_EQ(refused.claim, 0U);
  EXPECT_EQ(refused.other_fleet, "f1");
  EXPECT_EQ(refused.held_since, 0U);
  EXPECT_FALSE(refused.was_known);
  EXPECT_THAT(Commit(Sample(Mark(1))), ElementsAre(OutcomeKind::kStored)) << "the claim stands";
  EXPECT_EQ(Robots()[0].robot.fleet, "f1");
}

TEST_P(ClaimsContract, MovesNoRobotThatAnotherProcessGoesOnHolding) {
  if (!Renew(kOther)) return;
  OpenAt(0, kOther);
  const ClaimResult refused =
      ClaimEach({{Robot("a", "f2"), Time(1), FleetWord::kMoves}}, kProcess).front();
  EXPECT_EQ(refused.claim, 0U);
  EXPECT_EQ(refused.other_fleet, "f1");
  EXPECT_EQ(Robots()[0].robot.fleet, "f1");
  EXPECT_THAT(Commit({Good(1)}, kOther), ElementsAre(OutcomeKind::kStored));
}

TEST_P(ClaimsContract, AnswersManyInTheirOrder) {
  Open();
  const auto results = ClaimEach(
      {{Robot("z"), Time()}, {robot_, Time()}, {Robot("b", "f9"), Time(), FleetWord::kMatches}});
  ASSERT_THAT(results, SizeIs(3));
  EXPECT_FALSE(results[0].was_known);
  EXPECT_TRUE(results[1].was_known);
  EXPECT_EQ(results[1].held_since, held_since_);
  EXPECT_GT(results[2].claim, 0U) << "a robot that is new is of the gateway's fleet";
  EXPECT_NE(results[0].claim, results[1].claim);
}

INSTANTIATE_TEST_SUITE_P(Stores, ClaimsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
