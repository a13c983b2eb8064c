// Which robots come in: blocked ones, new ones, those of gateways without names, and moved ones.
#include "server/fleet/entry.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/fleet/fleet.h"
#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kRobot = "rcan://f/one";
constexpr const char* kTwin =
    "rcan://local.rcan/cyberwave/twin/11111111-2222-4333-8444-555555555555";

class EntryTest : public ::testing::Test {
 protected:
  EntryTest() { Rule({}); }

  void Rule(const EntryRules& rules) { fleet_.entry().Set(rules, settings_); }
  void StoreIsRead() {
    fleet_.odd_fleets().SetRead();
    settings_.SetRead();
  }
  void Sweep() { static_cast<void>(fleet_.Sweep(std::chrono::hours(1))); }
  void Apply(storage::RobotSetting setting) {
    setting.ruri = kRobot;
    setting.version = ++version_;
    settings_.Apply({setting});
  }
  static Claim Of(const std::string& ruri, const std::string& fleet = "f",
                  Grant grant = Grant::kOwn) {
    return {.robot = {.ruri = ruri, .fleet = fleet},
            .grant = grant,
            .gateway = grant == Grant::kOwn ? "" : "CN=hall"};
  }
  Refusal Come(const Claim& claim) { return fleet_.FindOrAdmitBy(claim).refusal; }

  testing::ManualClock clock_;
  RobotSettings settings_{10};
  Fleet fleet_{clock_, 10, {}};

 private:
  storage::AccessVersion version_ = 0;
};

TEST_F(EntryTest, AllComeInIfNothingIsSet) {
  Fleet plain(clock_, 10, {});
  EXPECT_EQ(plain.FindOrAdmitBy(Of(kRobot)).refusal, Refusal::kNone);
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone);
  EXPECT_EQ(Come(Of("rcan://f/two", "f", Grant::kFleet)), Refusal::kNone);
}

TEST_F(EntryTest, ABlockedRobotStaysOutWhetherItIsKnownOrNot) {
  Apply({.blocked = true});
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kBlocked);
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kNamed)), Refusal::kBlocked);
  EXPECT_EQ(fleet_.size(), 0U);
  Apply({});
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone);
  Apply({.blocked = true});
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kBlocked);
}

TEST_F(EntryTest, ARobotOfTheStoreIsBlockedFromTheStart) {
  Apply({.blocked = true});
  const auto robot = fleet_.AdmitNew({.ruri = kRobot, .fleet = "f"});
  ASSERT_TRUE(robot.ok());
  EXPECT_TRUE((*robot)->blocked());
}

TEST_F(EntryTest, AChangeReachesARobotInMemory) {
  settings_.OnChange(
      [this](std::span<const RobotSettings::Change> changes) { fleet_.OnSettings(changes); });
  const RobotPtr robot = fleet_.FindOrAdmitBy(Of(kRobot)).robot;
  EXPECT_FALSE(robot->blocked());
  Apply({.blocked = true});
  EXPECT_TRUE(robot->blocked());
  Apply({.note = "found"});
  EXPECT_FALSE(robot->blocked());
}

TEST_F(EntryTest, WhereRegistrationIsClosedANewRobotComesInOnceItWasAdded) {
  Rule({.only_registered = true});
  ASSERT_TRUE(fleet_.AdmitNew({.ruri = "rcan://f/known", .fleet = "f"}).ok());
  StoreIsRead();
  EXPECT_EQ(Come(Of("rcan://f/known")), Refusal::kNone);
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kFleet)), Refusal::kNotRegistered);
  ASSERT_THAT(fleet_.entry().candidates().All(), SizeIs(1));
  const Candidate candidate = fleet_.entry().candidates().All().front();
  EXPECT_EQ(candidate.robot.ruri, kRobot);
  EXPECT_EQ(candidate.gateway, "CN=hall");
  EXPECT_EQ(candidate.last_at, clock_.System());
  Apply({.registered = true});
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kFleet)), Refusal::kNone);
  EXPECT_THAT(fleet_.entry().candidates().All(), IsEmpty());
}

TEST_F(EntryTest, BeforeTheStoreWasReadAnyRobotMayBeKnown) {
  Rule({.only_registered = true});
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone);
  EXPECT_EQ(Come(Of("rcan://F/two")), Refusal::kRobotsUnread);
}

TEST_F(EntryTest, ARobotThatCameBeforeTheStoreWasReadIsJudgedOnceItIs) {
  Rule({.only_registered = true});
  const RobotPtr robot = fleet_.FindOrAdmitBy(Of(kRobot, "f", Grant::kNamed)).robot;
  ASSERT_NE(robot, nullptr);
  robot->SetSpeaker("CN=hall");
  fleet_.odd_fleets().SetRead();
  Sweep();
  EXPECT_EQ(robot->registration(), robot::Registration::kUnjudged) << "it may have been added";
  settings_.SetRead();
  Sweep();
  EXPECT_EQ(robot->registration(), robot::Registration::kRefused);
  EXPECT_TRUE(robot->kept_out());
  EXPECT_TRUE(robot->leaving());
  ASSERT_THAT(fleet_.entry().candidates().All(), SizeIs(1));
  EXPECT_EQ(fleet_.entry().candidates().All().front().gateway, "CN=hall");
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kNamed)), Refusal::kNotRegistered);
  Apply({.registered = true});
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kNamed)), Refusal::kNone);
  EXPECT_EQ(robot->registration(), robot::Registration::kFits);
  EXPECT_FALSE(robot->leaving());
}

TEST_F(EntryTest, RulesThatChangeCountForRobotsThatCome) {
  StoreIsRead();
  const RobotPtr before = fleet_.FindOrAdmitBy(Of(kRobot)).robot;
  fleet_.entry().Follow({.only_registered = true});
  EXPECT_EQ(Come(Of("rcan://f/two")), Refusal::kNotRegistered);
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone) << "it is known";
  Sweep();
  EXPECT_EQ(before->registration(), robot::Registration::kFits);
  fleet_.entry().Follow({.only_named = true, .fleets_stay = true});
  EXPECT_EQ(Come(Of("rcan://f/two")), Refusal::kNone);
  EXPECT_EQ(Come(Of("rcan://f/three", "f", Grant::kFleet)), Refusal::kGatewayUnnamed);
  EXPECT_EQ(Come(Of(kRobot, "g")), Refusal::kFleetStays);
}

TEST_F(EntryTest, ARobotThatWaitsIsLetInOnceRegistrationIsOpen) {
  Rule({.only_registered = true});
  const RobotPtr waits = fleet_.FindOrAdmitBy(Of(kRobot)).robot;
  EXPECT_EQ(waits->registration(), robot::Registration::kUnjudged);
  fleet_.entry().Follow({});
  StoreIsRead();
  Sweep();
  EXPECT_EQ(waits->registration(), robot::Registration::kFits);
  EXPECT_FALSE(waits->kept_out());
}

TEST_F(EntryTest, ARobotOfTheStoreThatCameBeforeStays) {
  Rule({.only_registered = true});
  const RobotPtr robot = fleet_.FindOrAdmitBy(Of(kRobot)).robot;
  EXPECT_EQ(robot->registration(), robot::Registration::kUnjudged);
  const auto known = fleet_.AdmitNew({.ruri = kRobot, .fleet = "f"});
  EXPECT_TRUE(known.ok() && *known == nullptr);
  StoreIsRead();
  Sweep();
  EXPECT_EQ(robot->registration(), robot::Registration::kFits);
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone);
  EXPECT_THAT(fleet_.entry().candidates().All(), IsEmpty());
}

TEST_F(EntryTest, ARobotThatWasAddedNeedsNoJudgement) {
  Rule({.only_registered = true});
  const RobotPtr later = fleet_.FindOrAdmitBy(Of(kRobot)).robot;
  Apply({.registered = true});
  EXPECT_EQ(fleet_.FindOrAdmitBy(Of(kRobot)).robot->registration(), robot::Registration::kFits);
  settings_.Apply({{.ruri = "rcan://f/two", .registered = true, .version = 9}});
  EXPECT_EQ(fleet_.FindOrAdmitBy(Of("rcan://f/two")).robot->registration(),
            robot::Registration::kFits);
  StoreIsRead();
  Sweep();
  EXPECT_FALSE(later->kept_out());
}

TEST_F(EntryTest, WhereRegistrationIsOpenNoRobotWaitsForTheStore) {
  EXPECT_EQ(fleet_.FindOrAdmitBy(Of(kRobot)).robot->registration(), robot::Registration::kFits);
}

TEST_F(EntryTest, ATwinMustBeAddedLikeAnyRobot) {
  Rule({.only_registered = true});
  StoreIsRead();
  const auto twin = fleet_.FindOrAdmit({.ruri = kTwin, .fleet = "f"});
  EXPECT_TRUE(absl::IsPermissionDenied(twin.status())) << twin.status();
  EXPECT_THAT(fleet_.entry().candidates().All(), SizeIs(1));
}

TEST_F(EntryTest, AGatewayMustNameItsRobotsWhereTheRuleSaysSo) {
  Rule({.only_named = true});
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kFleet)), Refusal::kGatewayUnnamed);
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kNamed)), Refusal::kNone);
  EXPECT_EQ(Come(Of(kRobot)), Refusal::kNone);
  EXPECT_EQ(fleet_.entry().TakeUnnamed(), std::nullopt) << "it was refused";
}

TEST_F(EntryTest, TheFirstGatewayWithoutNamesIsToldOnce) {
  EXPECT_EQ(fleet_.entry().TakeUnnamed(), std::nullopt);
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kFleet)), Refusal::kNone);
  EXPECT_EQ(fleet_.entry().TakeUnnamed(), "CN=hall");
  EXPECT_EQ(Come(Of(kRobot, "f", Grant::kFleet)), Refusal::kNone);
  EXPECT_EQ(fleet_.entry().TakeUnnamed(), std::nullopt);
}

TEST_F(EntryTest, ACertificateOfAnotherFleetMovesARobotUnlessFleetsStay) {
  EXPECT_EQ(Come(Of(kRobot, "north")), Refusal::kNone);
  EXPECT_EQ(Come(Of(kRobot, "south")), Refusal::kNone);
  EXPECT_EQ(fleet_.Find(kRobot)->id()->fleet, "south");
  EXPECT_TRUE(fleet_.entry().Moves(Of(kRobot)));
  EXPECT_FALSE(fleet_.entry().Moves(Of(kRobot, "f", Grant::kFleet)));
  Rule({.fleets_stay = true});
  EXPECT_EQ(Come(Of(kRobot, "north")), Refusal::kFleetStays);
  EXPECT_EQ(Come(Of(kRobot, "north", Grant::kNamed)), Refusal::kFleetStays);
  EXPECT_EQ(fleet_.Find(kRobot)->id()->fleet, "south");
  EXPECT_EQ(Come(Of(kRobot, "south")), Refusal::kNone);
  EXPECT_FALSE(fleet_.entry().Moves(Of(kRobot)));
}

TEST_F(EntryTest, AnAuthorityMovesARobotOutOfItsOwnFleetsAlone) {
  const auto by = [](Grant grant) {
    Claim claim = Of(kRobot, "south", grant);
    claim.bounds = std::make_shared<const identity::FleetBounds>(identity::FleetBounds{
        .authority = "guests", .fleets = identity::Scope::Of({"south", "west"})});
    return claim;
  };
  EXPECT_EQ(Come(Of(kRobot, "north")), Refusal::kNone);
  EXPECT_EQ(Come(by(Grant::kOwn)), Refusal::kAuthorityOutside);
  EXPECT_EQ(Come(by(Grant::kNamed)), Refusal::kAuthorityOutside);
  EXPECT_EQ(fleet_.Find(kRobot)->id()->fleet, "north");
  EXPECT_FALSE(fleet_.entry().Moves(by(Grant::kOwn))) << "the store may have it in any fleet";
  EXPECT_EQ(StatusOfEntry(Refusal::kAuthorityOutside, by(Grant::kOwn)).message(),
            "client certificate: its authority guests may not move this robot from its fleet");
  EXPECT_EQ(Come(Of(kRobot, "west")), Refusal::kNone);
  EXPECT_TRUE(fleet_.FindOrAdmitBy(by(Grant::kOwn)).moved);
  EXPECT_EQ(fleet_.Find(kRobot)->id()->fleet, "south");
  EXPECT_FALSE(fleet_.FindOrAdmitBy(by(Grant::kOwn)).moved);
}

TEST_F(EntryTest, TheConfigurationMovesATwinEvenIfFleetsStay) {
  ASSERT_TRUE(fleet_.FindOrAdmit({.ruri = kTwin, .fleet = "north"}).ok());
  Rule({.fleets_stay = true});
  EXPECT_TRUE(fleet_.FindOrAdmit({.ruri = kTwin, .fleet = "south"}).ok());
}

TEST_F(EntryTest, ANewRobotHasACanonicalRuriAndAKnownOneKeepsItsOwn) {
  ASSERT_TRUE(fleet_.AdmitNew({.ruri = "rcan://F/known", .fleet = "f"}).ok());
  StoreIsRead();
  EXPECT_EQ(Come(Of("rcan://F/known")), Refusal::kNone);
  EXPECT_EQ(Come(Of("rcan://F/new")), Refusal::kNotCanonical);
  EXPECT_EQ(Come(Of("rcan://f/new?sig=x")), Refusal::kNotCanonical);
  EXPECT_EQ(Come(Of("rcan://f/new")), Refusal::kNone);
}

TEST(StatusOfEntry, NamesWhatAnOperatorMustDo) {
  const Claim claim{.robot = {.ruri = "rcan://F/one", .fleet = "f"}, .gateway = "CN=hall"};
  const auto text = [&claim](Refusal refusal) {
    return std::string(StatusOfEntry(refusal, claim).message());
  };
  EXPECT_EQ(text(Refusal::kBlocked), "blocked");
  EXPECT_THAT(text(Refusal::kNotRegistered), HasSubstr("identity.registration"));
  EXPECT_THAT(text(Refusal::kGatewayUnnamed), HasSubstr("gateway CN=hall"));
  EXPECT_THAT(text(Refusal::kFleetStays), HasSubstr("identity.fleet_moves"));
  EXPECT_THAT(text(Refusal::kNotCanonical), HasSubstr("has a host with capital letters"));
  EXPECT_TRUE(absl::IsUnavailable(StatusOfEntry(Refusal::kRobotsUnread, claim)));
  EXPECT_TRUE(StatusOfEntry(Refusal::kFull, claim).ok());
}

}  // namespace
}  // namespace uplink::fleet
