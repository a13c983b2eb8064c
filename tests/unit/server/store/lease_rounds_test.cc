#include "server/store/lease_rounds.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/unit/server/store/lease_bench.h"

namespace uplink::store {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(LeaseRoundsTest, RaisesTheCounterEachFiveSeconds) {
  rounds_->Round();
  Pass(std::chrono::seconds(20));
  const auto leases = database_.ReadLeases();
  ASSERT_EQ(leases.size(), 1U);
  EXPECT_EQ(leases[0].counter, 5U);
  EXPECT_EQ(leases[0].card.name, HostName() + ":7443");
  EXPECT_EQ(leases[0].card.life, LifeOfThisProcess());
  EXPECT_EQ(probe_.renewed.value(), 5);
}

TEST_F(LeaseRoundsTest, ShowsWhatAnotherHoldsAsThatOneWroteIt) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  EXPECT_EQ(Shown().presence, model::Presence::kOnline);
  EXPECT_EQ(Shown().presence_since, FromUnixMs(7));
  EXPECT_EQ(Shown().foreign->held_by, "b:2");
  EXPECT_EQ(Shown().foreign->written_at, FromUnixMs(7));
  EXPECT_EQ(probe_.others.value(), 1);
  for (int i = 0; i < 30; ++i) {
    RenewOther();
    Pass(std::chrono::seconds(5));
  }
  EXPECT_THAT(History(), ElementsAre(model::Presence::kOnline)) << "and writes nothing of it";
  EXPECT_EQ(fleet_.presence_counts().elsewhere.online, 1);
}

TEST_F(LeaseRoundsTest, AdoptsTheRobotsOfASilentProcessAndCallsThemOfflineAfterAnHour) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  Pass(kSilentMax - kLookEvery);
  EXPECT_TRUE(Shown().foreign.has_value());
  Pass(2 * kLookEvery);
  EXPECT_FALSE(Shown().foreign.has_value());
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("process_late process=b:2"),
                                  HasSubstr("process_over process=b:2 why=silent robots=1")));
  EXPECT_EQ(journal_probe_.adopted.value(), 1);
  Pass(std::chrono::minutes(59));
  EXPECT_THAT(History(), ElementsAre(model::Presence::kUnknown, model::Presence::kOnline));
  Pass(std::chrono::minutes(2));
  EXPECT_THAT(History(), ElementsAre(model::Presence::kOffline, model::Presence::kUnknown,
                                     model::Presence::kOnline));
}

TEST_F(LeaseRoundsTest, AdoptsTheRobotsOfAReleasedLeaseAndCallsThemOfflineAfterTheGraceOfAStart) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  database_.Release(kOther);
  Pass(std::chrono::seconds(10));
  EXPECT_TRUE(Shown().foreign.has_value()) << "its robots may come by themselves";
  Pass(2 * kLookEvery);
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown);
  Pass(std::chrono::minutes(2) + kLookEvery);
  EXPECT_EQ(Shown().presence, model::Presence::kOffline);
}

TEST_F(LeaseRoundsTest, WhoWasOfflineAtAProcessThatStoppedStaysSoAndNothingIsWritten) {
  OpenAtOther(model::Presence::kOffline);
  RenewOther();
  rounds_->Round();
  database_.Release(kOther);
  Pass(std::chrono::seconds(10) + 2 * kLookEvery);
  EXPECT_FALSE(Shown().foreign.has_value());
  Pass(std::chrono::minutes(3));
  EXPECT_EQ(Shown().presence, model::Presence::kOffline);
  EXPECT_EQ(Shown().presence_since, FromUnixMs(7));
  EXPECT_THAT(History(), ElementsAre(model::Presence::kOffline));
}

TEST_F(LeaseRoundsTest, WhoWasOfflineAtAProcessThatFellSilentMayBeHeardThere) {
  OpenAtOther(model::Presence::kOffline);
  RenewOther();
  rounds_->Round();
  Pass(kSilentMax + kLookEvery);
  EXPECT_FALSE(Shown().foreign.has_value());
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown);
  Pass(std::chrono::hours(1));
  EXPECT_EQ(Shown().presence, model::Presence::kOffline);
  EXPECT_THAT(History(), ElementsAre(model::Presence::kOffline)) << "the row of the other one";
}

TEST_F(LeaseRoundsTest, AnAdoptionForSilenceStandsThoughTheAdopterStopped) {
  OpenAtOther();
  AdoptAtThird();
  Pass(std::chrono::seconds(15));
  EXPECT_EQ(journal_probe_.adopted.value(), 1);
  Pass(std::chrono::minutes(59));
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown) << "it may stream to the silent one";
  Pass(std::chrono::minutes(2));
  EXPECT_EQ(Shown().presence, model::Presence::kOffline);
}

TEST_F(LeaseRoundsTest, ARobotThatStreamedSinceTheSilenceWasAtTheOneThatStopped) {
  OpenAtOther();
  AdoptAtThird();
  const storage::OpenRequest request{.robot = robot_, .at = clock_.System()};
  ASSERT_TRUE(third_.OpenStreams({&request, 1}).ok());
  Pass(std::chrono::seconds(15));
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown);
  Pass(std::chrono::minutes(2) + kLookEvery);
  EXPECT_EQ(Shown().presence, model::Presence::kOffline);
}

TEST_F(LeaseRoundsTest, AListThatTakesLongKeepsTheLeasesInSight) {
  std::vector<storage::OpenRequest> requests;
  for (std::uint32_t i = 0; i <= storage::kForeignRobotsMax; ++i) {
    requests.push_back({.robot = std::make_shared<const model::RobotId>(
                            model::RobotId{"rcan://" + std::to_string(i), "f"}),
                        .at = clock_.System()});
  }
  ASSERT_TRUE(other_.OpenStreams(requests).ok());
  RenewOther();
  leases_->OnList([this] { clock_.Advance(std::chrono::seconds(4)); });
  rounds_->Round();
  EXPECT_EQ(probe_.renewed.value(), 2) << "at the beginning, and eight seconds later";
  for (int round = 0; round < 4; ++round) rounds_->Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("process_late"),
                                  HasSubstr("process_over process=b:2 why=silent robots=5")))
      << "those that this process may show";
}

TEST_F(LeaseRoundsTest, WhoWasNotHeardAnywhereForTooLongIsNotShown) {
  OpenAtOther();
  heard_since_ = FromUnixMs(8);
  rounds_->Round();
  EXPECT_EQ(fleet_.Find(robot_->ruri), nullptr);
  heard_since_ = FromUnixMs(7);
  rounds_->Round();
  ASSERT_NE(fleet_.Find(robot_->ruri), nullptr);
  EXPECT_TRUE(Shown().foreign.has_value());
}

TEST_F(LeaseRoundsTest, ARobotThatLeavesIsNotTakenBack) {
  OpenAtOther();
  rounds_->Round();
  const fleet::RobotPtr robot = fleet_.Find(robot_->ruri);
  ASSERT_TRUE(fleet_.BeginLeaving(*robot));
  const storage::AdoptRequest request{.robot = robot_, .holder = kOther};
  ASSERT_TRUE(ours_.Adopt({&request, 1})->front().held_since);
  Pass(std::chrono::seconds(10));
  EXPECT_EQ(robot->state.held_since(), 0U) << "the store says that it is ours, but is not asked";
}

TEST_F(LeaseRoundsTest, ARobotThatWentElsewhereIsLetGo) {
  robot::Robot& robot = **fleet_.FindOrAdmit(*robot_);
  journal_.Open(robot, 1, {.robot = robot_, .at = clock_.System()});
  Pass(kLookEvery);
  EXPECT_EQ(robot.state.held_since(), 1U);
  OpenAtOther();
  RenewOther();
  Pass(kLookEvery);
  EXPECT_EQ(robot.state.held_since(), 0U);
  Pass(kLookEvery);
  EXPECT_EQ(Shown().foreign->held_by, "b:2");
  EXPECT_EQ(Shown().presence, model::Presence::kOnline);
}

TEST_F(LeaseRoundsTest, WhoCannotRenewGoesOnUntilItsRobotsAreAdopted) {
  robot::Robot& robot = **fleet_.FindOrAdmit(*robot_);
  journal_.Open(robot, 1, {.robot = robot_, .at = clock_.System()});
  Pass(kLookEvery);
  leases_->SetAway(true);
  Pass(kSilentMax);
  EXPECT_EQ(probe_.failing.value(), 1);
  EXPECT_EQ(robot.state.held_since(), 1U) << "it is not adopted yet, and commits go on";
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  Pass(kLookEvery);
  EXPECT_THAT(History(), ElementsAre(model::Presence::kOnline));
  storage::AdoptRequest request{
      .robot = robot_, .holder = kSelf, .end = storage::HolderEnd::kSilent};
  for (const storage::Lease& lease : database_.ReadLeases()) {
    if (lease.process == kSelf) request.lease_counter = lease.counter;
  }
  ASSERT_TRUE(other_.Adopt({&request, 1})->front().held_since);
  RenewOther();
  leases_->SetAway(false);
  Pass(2 * kLookEvery);
  EXPECT_EQ(robot.state.held_since(), 0U);
  EXPECT_EQ(Shown().foreign->held_by, "b:2");
}

TEST_F(LeaseRoundsTest, ShowsTheSessionThatTheHolderHas) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  EXPECT_EQ(fleet_.Find(robot_->ruri)->sessions.View().session, model::SessionId());
  EXPECT_EQ(fleet_.Find(robot_->ruri)->sessions.View().settled_seq, 0U);
  storage::Batch batch;
  batch.records = {{.robot = robot_,
                    .seq = 7,
                    .held_since = 1,
                    .received_at = clock_.System(),
                    .content = storage::QuarantineItem{}}};
  ASSERT_TRUE(other_.Commit(batch).ok());
  RenewOther();
  Pass(kLookEvery);
  EXPECT_EQ(fleet_.Find(robot_->ruri)->sessions.View().settled_seq, 7U);
}

TEST_F(LeaseRoundsTest, AFleetThatTheStoreDoesNotKnowYetStays) {
  OpenAtOther();
  robot::Robot& robot = **fleet_.FindOrAdmit({robot_->ruri, "new"});
  journal_.Open(robot, 1, {.robot = robot.id(), .at = clock_.System()});
  static_cast<void>(journal_.turns().Advance());
  rounds_->Round();
  EXPECT_EQ(robot.id()->fleet, "new");
}

TEST_F(LeaseRoundsTest, OfTwoThatLeaveAtOnceTheLastFindsNobody) {
  RenewOther();
  rounds_->Round();
  EXPECT_EQ(probe_.others.value(), 1);
  database_.Release(kOther);
  EXPECT_EQ(rounds_->Leave(), LeaseRounds::Left::kToNone) << "though it was there a moment ago";
}

TEST_F(LeaseRoundsTest, WhoLeavesAnotherLeavesTheRobotsToIt) {
  RenewOther();
  rounds_->Round();
  EXPECT_EQ(rounds_->Leave(), LeaseRounds::Left::kToOthers);
}

TEST_F(LeaseRoundsTest, ARobotThatIsOursByAnAnswerThatNeverCameIsJudgedAgain) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  EXPECT_TRUE(Shown().foreign.has_value());
  const storage::OpenRequest late{.robot = robot_, .at = clock_.System()};
  ASSERT_TRUE(ours_.OpenStreams({&late, 1}).ok());
  RenewOther();
  Pass(2 * kLookEvery);
  EXPECT_FALSE(Shown().foreign.has_value());
  EXPECT_EQ(fleet_.Find(robot_->ruri)->state.held_since(), 3U - 1U);
  EXPECT_EQ(Shown().presence, model::Presence::kUnknown);
}

TEST_F(LeaseRoundsTest, ARobotWhoseRowIsGoneLeavesMemory) {
  RenewOther();
  OpenAtOther();
  rounds_->Round();
  ASSERT_EQ(Shown().presence, model::Presence::kOnline) << "as its holder wrote it";
  database_.DeleteRobotRow(robot_->ruri);
  Pass(kLookEvery * kUnlistedLooksMax);
  EXPECT_FALSE(fleet_.Find(robot_->ruri)->leaving()) << "an answer may be on its way";
  Pass(kLookEvery);
  EXPECT_TRUE(fleet_.Find(robot_->ruri)->leaving());
  journals_.Leave({fleet_.Find(robot_->ruri).get(), robot_});
  Pass(kLookEvery);
  EXPECT_EQ(fleet_.RemoveLeft().size(), 1U);
  EXPECT_EQ(fleet_.Find(robot_->ruri), nullptr);
}

TEST_F(LeaseRoundsTest, AProcessThatIsLateIsCountedAndNamedOnce) {
  RenewOther();
  Pass(kLateAfter);
  EXPECT_EQ(probe_.others_late.value(), 0);
  Pass(kLookEvery);
  EXPECT_EQ(probe_.others_late.value(), 1);
  EXPECT_EQ(probe_.others_unseen.value(), 1);
  Pass(kLateAfter);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("process_late process=b:2")));
  RenewOther();
  Pass(kLookEvery);
  EXPECT_EQ(probe_.others_late.value(), 0);
  EXPECT_EQ(probe_.others_unseen.value(), 0);
  leases_->SetAway(true);
  Pass(kLookEvery);
  EXPECT_EQ(probe_.others_late.value(), 0) << "its lease was in time when we looked";
  EXPECT_EQ(probe_.others_unseen.value(), 1) << "what it does now is not known";
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("process_late"), HasSubstr("lease_fails")));
}

TEST_F(LeaseRoundsTest, TheNameIsRenewedWithThePort) {
  rounds_->Round();
  rounds_->SetPort(9);
  rounds_->Round();
  EXPECT_EQ(database_.ReadLeases().front().card.name, HostName() + ":9");
}

TEST_F(LeaseRoundsTest, WhoStopsAdoptsNobody) {
  OpenAtOther();
  RenewOther();
  database_.Release(kOther);
  rounds_->StopAdopting();
  Pass(std::chrono::seconds(20));
  EXPECT_TRUE(Shown().foreign.has_value());
  EXPECT_GT(probe_.renewed.value(), 1) << "its own lease stands until it is released";
}

TEST_F(LeaseRoundsTest, MoreRobotsThanThereMayBeAreLeftToTheirHolder) {
  for (const char* ruri : {"a", "b", "c", "d", "e"}) {
    ASSERT_TRUE(fleet_.FindOrAdmit({ruri, "f"}).ok());
  }
  OpenAtOther();
  rounds_->Round();
  EXPECT_EQ(fleet_.Find(robot_->ruri), nullptr);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(LeaseRoundsTest, RunsOnAThreadOfItsOwnAndReleases) {
  rounds_->Start();
  EXPECT_TRUE(testing::Eventually([&] { return !database_.ReadLeases().empty(); }));
  rounds_->Stop();
  rounds_->Stop();
  EXPECT_EQ(rounds_->Leave(), LeaseRounds::Left::kToNone);
  EXPECT_TRUE(database_.ReadLeases().front().released);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(LeaseRoundsTest, WhoIsAskedForIsJudgedByARoundThatComesAtOnce) {
  rounds_->Start();
  ASSERT_TRUE(testing::Eventually([&] { return !database_.ReadLeases().empty(); }));
  ASSERT_EQ(rounds_->VerdictOf(kOther), std::nullopt);
  // Well below the time between two rounds.
  EXPECT_TRUE(
      testing::Eventually([&] { return rounds_->VerdictOf(kOther).has_value(); }, kLookEvery / 2));
  rounds_->Stop();
}

TEST_F(LeaseRoundsTest, AReleaseThatFailsIsALine) {
  leases_->SetAway(true);
  EXPECT_EQ(rounds_->Leave(), LeaseRounds::Left::kToNone);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("lease_not_released")));
}

TEST_F(LeaseRoundsTest, AStoreThatOneProcessHasNeedsNone) {
  LeaseRounds none(nullptr, {.fleet = fleet_,
                             .journals = journals_,
                             .clock = clock_,
                             .logger = logger_,
                             .probe = probe_});
  none.Round();
  none.Start();
  none.Stop();
  EXPECT_EQ(none.Leave(), LeaseRounds::Left::kToNone);
  EXPECT_EQ(probe_.renewed.value(), 0);
}

}  // namespace
}  // namespace uplink::store
