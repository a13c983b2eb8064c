// Leases while the store is away, hangs or becomes another one.
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/store/lease_bench.h"

namespace uplink::store {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(LeaseRoundsTest, AConnectionThatEndsBetweenAnyTwoLooksHidesNothing) {
  OpenAtOther();
  RenewOther();
  for (milliseconds passed{0}; passed <= kSilentMax + kLookEvery; passed += kLookEvery) {
    leases_->Break();
    Pass(kLookEvery);
  }
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("process_late"), HasSubstr("process_over")));
}

TEST_F(LeaseRoundsTest, AnotherServerMayLackWhoHeardARobotSince) {
  robot::Robot& robot = **fleet_.FindOrAdmit(*robot_);
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
  Pass(std::chrono::seconds(10));
  testing::FakeDatabase standby;
  standby.CopyRowsOf(database_);
  database_.CopyRowsOf(standby);
  Pass(std::chrono::seconds(10));
  EXPECT_EQ(robot.state.presence(), robot::Presence::kUnknown) << "a timeout to come back";
  Pass(fleet::Fleet::kReplacedKnown + 2 * kLookEvery);
  EXPECT_EQ(robot.state.presence(), robot::Presence::kOffline);
}

TEST_F(LeaseRoundsTest, WhoBecameOfflineSinceTheLastLookIsInDoubtOnceTheStoreIsAnother) {
  robot::Robot& robot = **fleet_.FindOrAdmit(*robot_);
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
  Pass(std::chrono::seconds(10));
  leases_->SetAway(true);
  Pass(std::chrono::minutes(1));
  ASSERT_EQ(robot.state.presence(), robot::Presence::kOffline);
  testing::FakeDatabase standby;
  standby.CopyRowsOf(database_);
  database_.CopyRowsOf(standby);
  leases_->SetAway(false);
  Pass(kLookEvery);
  EXPECT_EQ(robot.state.presence(), robot::Presence::kUnknown);
}

TEST_F(LeaseRoundsTest, AProcessThatIsAloneAtItsStoreLeavesNothingInDoubt) {
  LeaseRounds alone(nullptr, {.fleet = fleet_,
                              .journals = journals_,
                              .clock = clock_,
                              .logger = logger_,
                              .probe = probe_,
                              .process = kSelf});
  clock_.Advance(2 * kLookGapMax);
  EXPECT_FALSE(alone.OthersUnseen());
}

TEST_F(LeaseRoundsTest, WhileALookHangsOthersMayHearRobots) {
  RenewOther();
  Pass(kLookEvery);
  std::vector<bool> unseen;
  const auto wait = [&](milliseconds time) {
    clock_.Advance(time);
    unseen.push_back(rounds_->OthersUnseen());
  };
  leases_->OnList([&] {
    wait(kLookGapMax);
    wait(milliseconds(1));
    wait(config::PresenceConfig().adopted_grace - milliseconds(1));
    wait(milliseconds(1));
  });
  rounds_->Round();
  leases_->OnList({});
  EXPECT_THAT(unseen, ElementsAre(false, true, true, false));
  RenewOther();
  rounds_->Round();
  EXPECT_FALSE(rounds_->OthersUnseen());
}

TEST_F(LeaseRoundsTest, AStoreThatWasAwayEndsNobodysLease) {
  OpenAtOther();
  RenewOther();
  rounds_->Round();
  leases_->SetAway(true);
  Pass(std::chrono::minutes(2));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("lease_fails")));
  EXPECT_EQ(probe_.failing.value(), 1);
  leases_->SetAway(false);
  Pass(kSilentMax);
  EXPECT_TRUE(Shown().foreign.has_value());
  RenewOther();
  Pass(kSilentMax);
  EXPECT_TRUE(Shown().foreign.has_value());
  EXPECT_THAT(lines_, Not(Contains(HasSubstr("process_over"))));
  EXPECT_THAT(lines_, Contains(HasSubstr("lease_works_again")).Times(1));
  EXPECT_EQ(probe_.failing.value(), 0);
}

TEST_F(LeaseRoundsTest, AsksForTheEndOnceWhereTheSchemaShutsThisProgramOut) {
  rounds_->Round();
  EXPECT_EQ(shut_outs_, 0);
  leases_->ShutOut();
  Pass(std::chrono::seconds(20));
  EXPECT_EQ(shut_outs_, 1);
  EXPECT_THAT(lines_, ElementsAre(AllOf(HasSubstr("store_outdated_program"),
                                        HasSubstr("run a newer uplinkd"))));
  EXPECT_EQ(probe_.failing.value(), 0);
}

}  // namespace
}  // namespace uplink::store
