#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

/// Robots that change from one process to another.
namespace uplink::testing {
namespace {

using model::Presence;
using storage::AdoptRequest;
using storage::AdoptResult;
using storage::HolderEnd;
using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class AdoptContract : public StoreContract {
 protected:
  AdoptRequest Of(storage::RobotRef robot, std::uint64_t counter = 0) const {
    return {std::move(robot), storage::ProcessId{kProcess}, counter};
  }
  std::vector<AdoptResult> Adopt(const std::vector<AdoptRequest>& requests,
                                 std::uint8_t process = kOther) {
    auto results = store_->Process(process).Adopt(requests);
    EXPECT_TRUE(results.ok()) << results.status();
    return results.ok() ? *std::move(results) : std::vector<AdoptResult>(requests.size());
  }
  void CommitPresence(Presence presence) {
    storage::Batch batch;
    batch.presence = {{robot_, presence, Time(7), 1, held_since_}};
    batch.presence_session = Session(99);
    Commit(batch);
  }
};

TEST_P(AdoptContract, RaisesTheEpochAndFencesTheFormerHolder) {
  const storage::OpenResult opened = Open();
  const storage::Epoch old_hold = opened.held_since;
  const auto adopted = Adopt({Of(robot_)});
  ASSERT_THAT(adopted, SizeIs(1));
  ASSERT_TRUE(adopted[0].held_since.has_value());
  EXPECT_GT(*adopted[0].held_since, opened.epoch);
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kFenced));
  held_since_ = *adopted[0].held_since;
  EXPECT_THAT(Commit({Good(1)}, kOther), ElementsAre(OutcomeKind::kStored));
  EXPECT_LT(old_hold, held_since_);
  EXPECT_EQ(Open(Request(), kOther).held_since, *adopted[0].held_since)
      << "a stream at the adopter goes on with its hold";
}

TEST_P(AdoptContract, GoesToOneOfTwo) {
  Open();
  const auto first = Adopt({Of(robot_)}, 3)[0].held_since;
  EXPECT_TRUE(first.has_value());
  EXPECT_FALSE(Adopt({Of(robot_)}, 4)[0].held_since.has_value());
  EXPECT_EQ(Adopt({Of(robot_)}, 3)[0].held_since, first) << "it is its own already";
}

TEST_P(AdoptContract, LeavesARobotThatOpenedAStreamElsewhereMeanwhile) {
  Open();
  Open(Request(), 3);
  EXPECT_FALSE(Adopt({Of(robot_)})[0].held_since.has_value());
  EXPECT_THAT(Commit({Good(1)}, 3), ElementsAre(OutcomeKind::kStored));
}

TEST_P(AdoptContract, KnowsNothingOfARobotThatTheStoreLost) {
  EXPECT_FALSE(Adopt({Of(robot_)})[0].held_since.has_value());
  Open();
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_FALSE(Adopt({Of(robot_)})[0].held_since.has_value());
  EXPECT_FALSE(Adopt({Of(robot_)}, kProcess)[0].held_since.has_value()) << "its own, until then";
  EXPECT_EQ(*store_->reader().RobotCount(), 0U) << "it is not made by that";
  EXPECT_THAT(Adopt({}), IsEmpty());
}

TEST_P(AdoptContract, TellsThePresenceThatTheFormerHolderWrote) {
  Open();
  EXPECT_EQ(Adopt({Of(robot_)}, 3)[0].presence, std::nullopt);
  EXPECT_EQ(Open().presence, std::nullopt);
  CommitPresence(Presence::kOnline);
  const storage::StoredPresence online{Presence::kOnline, Time(7)};
  const storage::RobotRef other = Robot("b");
  storage::OpenRequest request = Request();
  request.robot = other;
  ASSERT_TRUE(store_->Process(kProcess).OpenStreams({&request, 1}).ok());
  const auto adopted = Adopt({Of(other), Of(robot_)});
  EXPECT_EQ(adopted[0].presence, std::nullopt);
  EXPECT_EQ(adopted[1].presence, online);
  EXPECT_EQ(Open().presence, online);
}

TEST_P(AdoptContract, RemembersASilentHolderUntilTheNextStream) {
  Open();
  AdoptRequest silent = Of(robot_);
  silent.end = HolderEnd::kSilent;
  EXPECT_EQ(Adopt({silent}, 3)[0].end, HolderEnd::kSilent);
  AdoptRequest next = {robot_, storage::ProcessId{3}, 0};
  EXPECT_EQ(Adopt({next}, 4)[0].end, HolderEnd::kSilent) << "of the first, though the second ended";
  EXPECT_EQ(Adopt({next}, 4)[0].end, HolderEnd::kSilent) << "told again";
  Open(Request(), 4);
  next.holder = storage::ProcessId{4};
  EXPECT_EQ(Adopt({next}, 5)[0].end, HolderEnd::kEnded);
  next.holder = storage::ProcessId{9};
  next.end = HolderEnd::kSilent;
  EXPECT_EQ(Adopt({next}, 5)[0].end, HolderEnd::kEnded) << "its own since then";
}

TEST_P(AdoptContract, KeepsNothingThatFailsAndAllOfALostAnswer) {
  Open();
  store_->FailNextWrite(kOther);
  const std::vector<AdoptRequest> requests = {Of(robot_)};
  EXPECT_FALSE(store_->Process(kOther).Adopt(requests).ok());
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kStored));
  store_->LoseNextAnswer(kOther);
  EXPECT_FALSE(store_->Process(kOther).Adopt(requests).ok());
  EXPECT_THAT(Commit({Good(2)}), ElementsAre(OutcomeKind::kFenced));
  const auto again = Adopt(requests)[0].held_since;
  ASSERT_TRUE(again.has_value()) << "a lost answer is told again";
  held_since_ = *again;
  EXPECT_THAT(Commit({Good(2)}, kOther), ElementsAre(OutcomeKind::kStored));
}

TEST_P(AdoptContract, WhoAdoptedWritesTheCheckpoints) {
  Open();
  storage::LiveRow row;
  row.ruri = robot_->ruri;
  row.last_sign_of_life = Time();
  row.held_since = held_since_;
  const auto adopted = Adopt({Of(robot_)})[0].held_since;
  ASSERT_TRUE(adopted.has_value());
  EXPECT_THAT(*store_->Process(kOther).Checkpoint({&row, 1}), SizeIs(1)) << "of another hold";
  row.held_since = *adopted;
  const std::vector<storage::LiveRow> rows = {row};
  EXPECT_THAT(*store_->Process(kProcess).Checkpoint(rows), SizeIs(1)) << "passed over";
  EXPECT_THAT(*store_->Process(kOther).Checkpoint(rows), IsEmpty());
  const std::vector<std::string> ruris = {"rcan://robots/0", robot_->ruri};
  const auto live = store_->reader().LiveOf(ruris);
  ASSERT_TRUE(live.ok()) << live.status();
  EXPECT_THAT(live->rows, ElementsAre(row));
  EXPECT_EQ(live->complete, 2U);
}

INSTANTIATE_TEST_SUITE_P(Stores, AdoptContract, EveryStore(), NameOfKind);

/// Processes that share a store: those that several may have at a time.
class LeaseContract : public AdoptContract {
 protected:
  storage::Leases& LeasesOf(std::uint8_t process) { return *store_->LeasesOf(process); }
  std::vector<storage::Lease> Read(std::uint8_t process = kProcess) {
    auto leases = LeasesOf(process).Read();
    EXPECT_TRUE(leases.ok()) << leases.status();
    return leases.ok() ? *std::move(leases) : std::vector<storage::Lease>();
  }
  void Renew(std::uint8_t process, int times = 1) {
    for (int i = 0; i < times; ++i) {
      const absl::Status renewed = LeasesOf(process).Renew({"host:1", "life"});
      EXPECT_TRUE(renewed.ok()) << renewed;
    }
  }
  storage::OpenResult OpenEnded(std::uint8_t process) {
    storage::OpenRequest request = Request();
    request.stream = storage::StreamState::kEnded;
    const auto results = store_->Process(process).OpenStreams({&request, 1});
    EXPECT_TRUE(results.ok()) << results.status();
    return results.ok() ? results->front() : storage::OpenResult();
  }
};

TEST_P(LeaseContract, CountsAndSaysWhoIsWhere) {
  EXPECT_THAT(Read(), IsEmpty());
  Renew(kProcess, 3);
  const auto leases = Read(kOther);
  ASSERT_THAT(leases, SizeIs(1));
  EXPECT_EQ(leases[0].process, storage::ProcessId{kProcess});
  EXPECT_EQ(leases[0].card.name, "host:1");
  EXPECT_EQ(leases[0].card.life, "life");
  EXPECT_EQ(leases[0].counter, 3U);
  EXPECT_FALSE(leases[0].released);
  Renew(kOther);
  EXPECT_THAT(Read(), SizeIs(2));
}

TEST_P(LeaseContract, IsReleasedForGood) {
  EXPECT_TRUE(LeasesOf(kProcess).Release().ok()) << "of no lease";
  EXPECT_THAT(Read(), IsEmpty());
  Renew(kProcess);
  EXPECT_TRUE(LeasesOf(kProcess).Release().ok());
  EXPECT_TRUE(Read().at(0).released);
  EXPECT_EQ(Read().at(0).counter, 1U);
  Renew(kProcess);
  EXPECT_TRUE(Read().at(0).released) << "a renewal that comes late undoes nothing";
  EXPECT_EQ(Read().at(0).counter, 2U);
}

TEST_P(LeaseContract, KeepsTheRobotsOfWhoRenewedMeanwhile) {
  Open();
  Renew(kProcess, 2);
  EXPECT_FALSE(Adopt({Of(robot_, 1)})[0].held_since.has_value());
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kStored));
  EXPECT_TRUE(Adopt({Of(robot_, 2)})[0].held_since.has_value());
}

TEST_P(LeaseContract, KeepsTheRobotsOfWhoseCounterWentBack) {
  Open();
  Renew(kProcess, 2);
  // Judged before a failover to a standby that had missed renewals: its holder goes on from there.
  EXPECT_FALSE(Adopt({Of(robot_, 5)})[0].held_since.has_value());
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kStored));
}

TEST_P(LeaseContract, AnEndedStreamTakesNoRobotFromWhoHasALease) {
  Open(Request(), kOther);
  Renew(kOther);
  const storage::OpenResult refused = OpenEnded(kProcess);
  EXPECT_FALSE(refused.taken);
  EXPECT_THAT(Commit({Good(1)}, kOther), ElementsAre(OutcomeKind::kStored)) << "it holds the robot";
  EXPECT_TRUE(OpenEnded(kOther).taken) << "one's own";
  EXPECT_TRUE(Open(Request(), kProcess).taken) << "a stream that is there";
}

TEST_P(LeaseContract, AnEndedStreamTakesARobotOfNobody) {
  Open(Request(), kOther);
  EXPECT_TRUE(OpenEnded(kProcess).taken) << "the other has no lease";
  Open(Request(), kOther);
  Renew(kOther);
  EXPECT_TRUE(LeasesOf(kOther).Release().ok());
  EXPECT_TRUE(OpenEnded(kProcess).taken) << "the other gave it up";
  storage::OpenRequest request = Request();
  request.robot = Robot("new");
  request.stream = storage::StreamState::kEnded;
  EXPECT_TRUE(store_->Process(kProcess).OpenStreams({&request, 1})->front().taken);
}

TEST_P(LeaseContract, AnEndedStreamLeavesNoTrace) {
  Open(Request(), kOther);
  Renew(kOther);
  storage::OpenRequest request = Request();
  request.session = Session(50);
  request.stream = storage::StreamState::kEnded;
  const auto refused = store_->Process(kProcess).OpenStreams({&request, 1});
  ASSERT_TRUE(refused.ok());
  EXPECT_FALSE(refused->front().taken);
  const auto robots = store_->reader().Robots(10);
  ASSERT_TRUE(robots.ok());
  ASSERT_THAT(*robots, SizeIs(1));
  EXPECT_EQ(robots->front().holder, storage::ProcessId{kOther});
  ASSERT_TRUE(robots->front().last_session.has_value());
  EXPECT_EQ(robots->front().last_session->session, session_);
}

TEST_P(LeaseContract, ListsTheRobotsOfOthers) {
  Open();
  CommitPresence(Presence::kOnline);
  storage::OpenRequest request = Request();
  request.robot = Robot("b", "f2");
  const storage::Epoch hold = Open(request, kOther).held_since;
  auto of_others = LeasesOf(kProcess).RobotsOfOthers("");
  ASSERT_TRUE(of_others.ok()) << of_others.status();
  ASSERT_THAT(*of_others, SizeIs(1));
  EXPECT_EQ(of_others->front().robot, *request.robot);
  EXPECT_EQ(of_others->front().holder, storage::ProcessId{kOther});
  EXPECT_EQ(of_others->front().held_since, hold);
  EXPECT_EQ(of_others->front().presence, std::nullopt);
  EXPECT_EQ(of_others->front().written_at, std::nullopt);
  of_others = LeasesOf(kOther).RobotsOfOthers("");
  ASSERT_TRUE(of_others.ok()) << of_others.status();
  ASSERT_THAT(*of_others, SizeIs(1));
  EXPECT_EQ(of_others->front().presence, (storage::StoredPresence{Presence::kOnline, Time(7)}));
  EXPECT_EQ(of_others->front().written_at, Time(7));
  EXPECT_THAT(*LeasesOf(kOther).RobotsOfOthers(robot_->ruri), IsEmpty());
  EXPECT_THAT(*LeasesOf(7).RobotsOfOthers(""), SizeIs(2));
}

TEST_P(LeaseContract, ListsTheRobotsOfOthersPageByPage) {
  std::vector<storage::OpenRequest> requests(storage::kForeignRobotsMax + 1, Request());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    requests[i].robot = Robot(std::to_string(10'000 + i));
  }
  ASSERT_TRUE(store_->Process(kOther).OpenStreams(requests).ok());
  const auto first = LeasesOf(kProcess).RobotsOfOthers("");
  ASSERT_TRUE(first.ok()) << first.status();
  ASSERT_THAT(*first, SizeIs(storage::kForeignRobotsMax));
  const auto rest = LeasesOf(kProcess).RobotsOfOthers(first->back().robot.ruri);
  ASSERT_TRUE(rest.ok()) << rest.status();
  ASSERT_THAT(*rest, SizeIs(1));
  EXPECT_EQ(rest->front().robot, *requests.back().robot);
  EXPECT_THAT(*LeasesOf(kProcess).RobotsOfOthers(rest->front().robot.ruri), IsEmpty());
}

TEST_P(LeaseContract, TellsTheSessionOfTheHoldersCheckpoint) {
  Open(Request(), kOther);
  Commit({Good(5)}, kOther);
  const auto session = [this] {
    const auto robots = LeasesOf(kProcess).RobotsOfOthers("");
    EXPECT_TRUE(robots.ok() && robots->size() == 1 && robots->front().last_session);
    return robots->front().last_session.value_or(storage::SettledSession());
  };
  EXPECT_EQ(session(), (storage::SettledSession{session_, 5})) << "before the first checkpoint";
  storage::LiveRow row{.ruri = robot_->ruri, .held_since = held_since_};
  row.session = {session_, 9};
  EXPECT_THAT(*store_->Process(kOther).Checkpoint({&row, 1}), IsEmpty());
  EXPECT_EQ(session(), (storage::SettledSession{session_, 9}));
}

INSTANTIATE_TEST_SUITE_P(Stores, LeaseContract, ::testing::Values(FakeKind(), PostgresKind()),
                         NameOfKind);

}  // namespace
}  // namespace uplink::testing
