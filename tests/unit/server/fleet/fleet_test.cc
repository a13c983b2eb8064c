#include "server/fleet/fleet.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/exposition.h"
#include "server/fleet/samples.h"
#include "storage/origin.h"
#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

using std::chrono::seconds;

constexpr milliseconds kIdle = std::chrono::hours(1);
constexpr const char* kTwin =
    "rcan://local.rcan/cyberwave/twin/3f2504e0-4f89-11d3-9a0c-0305e82c3301";

class FleetTest : public ::testing::Test {
 protected:
  robot::Robot& Admit(Fleet& fleet, const std::string& ruri) {
    const auto robot = fleet.FindOrAdmit({.ruri = ruri, .fleet = "north"});
    EXPECT_TRUE(robot.ok());
    return **robot;
  }
  testing::ManualClock clock_;
};

TEST_F(FleetTest, AdmitsARobotOnce) {
  Fleet fleet(clock_, 10, {});
  robot::Robot& robot = Admit(fleet, "rcan://a");
  EXPECT_EQ(&Admit(fleet, "rcan://a"), &robot);
  EXPECT_EQ(fleet.size(), 1U);
  EXPECT_EQ(fleet.Find("rcan://a").get(), &robot);
  EXPECT_EQ(fleet.Find("rcan://b"), nullptr);
  EXPECT_EQ(*robot.id(), (model::RobotId{.ruri = "rcan://a", .fleet = "north"}));
}

TEST_F(FleetTest, TheFleetPartFollowsTheCertificate) {
  Fleet fleet(clock_, 10, {});
  const storage::RobotRef before = Admit(fleet, "rcan://a").id();
  ASSERT_TRUE(fleet.FindOrAdmit({.ruri = "rcan://a", .fleet = "south"}).ok());
  EXPECT_EQ(fleet.Find("rcan://a")->id()->fleet, "south");
  EXPECT_EQ(before->fleet, "north") << "what was taken under it keeps it";
}

TEST_F(FleetTest, RobotsMaxIsTheLast) {
  Fleet fleet(clock_, 2, {});
  Admit(fleet, "rcan://a");
  Admit(fleet, "rcan://b");
  const auto third = fleet.FindOrAdmit({.ruri = "rcan://c", .fleet = "north"});
  EXPECT_EQ(third.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(std::string(third.status().message()),
            "the server admits no more than 2 robots (limits.robots_max)");
  EXPECT_EQ(fleet.size(), 2U);
  EXPECT_EQ(fleet.Find("rcan://c"), nullptr);
  Admit(fleet, "rcan://a");
}

TEST_F(FleetTest, SortedIsByRuri) {
  Fleet fleet(clock_, 100, {});
  for (const char* const ruri : {"rcan://c", "rcan://a", "rcan://b", "rcan://0"}) {
    Admit(fleet, ruri);
  }
  std::vector<std::string> ruris;
  for (const fleet::RobotPtr& robot : fleet.Sorted()) ruris.push_back(robot->ruri());
  EXPECT_THAT(ruris, ElementsAre("rcan://0", "rcan://a", "rcan://b", "rcan://c"));
}

TEST_F(FleetTest, SweepCountsPresence) {
  Fleet fleet(clock_, 100, {});
  robot::Robot& heard = Admit(fleet, "rcan://heard");
  robot::Robot& held = Admit(fleet, "rcan://held");
  Admit(fleet, "rcan://silent");
  held.state.SetReading(robot::RobotState::Reading::kHeldBack, clock_.Steady());
  clock_.Advance(fleet.presence_limits().startup_grace + milliseconds(1));
  heard.state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits());
  const PresenceCounts counts = fleet.Sweep(kIdle);
  EXPECT_EQ(counts.online, 1);
  EXPECT_EQ(counts.unknown, 1);
  EXPECT_EQ(counts.offline, 1);
  EXPECT_EQ(fleet.presence_counts().offline, 1);
}

TEST_F(FleetTest, SweepCountsOfTheOfflineRobotsThoseThatAreParked) {
  Fleet fleet(clock_, 100, {});
  robot::Robot& parked = Admit(fleet, "rcan://parked");
  Admit(fleet, "rcan://silent");
  robot::Robot& elsewhere = Admit(fleet, "rcan://elsewhere");
  const SystemTime until = clock_.System() + std::chrono::hours(2);
  parked.state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits());
  parked.state.Park(until, clock_.Steady());
  elsewhere.state.FollowHolder({}, {robot::Presence::kOffline, clock_.System(), until});
  clock_.Advance(fleet.presence_limits().startup_grace + milliseconds(1));
  robot::Robot& leaves = Admit(fleet, "rcan://leaves");
  leaves.state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits());
  leaves.state.Park(until, clock_.Steady());
  const PresenceCounts counts = fleet.Sweep(kIdle);
  EXPECT_EQ(counts.online, 1);
  EXPECT_EQ(counts.offline, 2);
  EXPECT_EQ(counts.parked, 1) << "the one that leaves is still online";
  EXPECT_EQ(counts.elsewhere.parked, 1);
}

TEST_F(FleetTest, SweepCountsByFleetAsManyAsAreShown) {
  Fleet fleet(clock_, 100, {});
  EXPECT_THAT(fleet.fleet_tallies(), ElementsAre(Pair("_other", _))) << "before the first sweep";
  fleet.ShowFleets(1);
  Admit(fleet, "rcan://a");
  Admit(fleet, "rcan://b")
      .state.FollowHolder({}, {.presence = robot::Presence::kOnline, .since = clock_.System()});
  ASSERT_TRUE(fleet.FindOrAdmit({.ruri = "rcan://c", .fleet = "south"}).ok());
  clock_.Advance(fleet.presence_limits().startup_grace + milliseconds(1));
  fleet.Sweep(kIdle);
  const FleetTallies tallies = fleet.fleet_tallies();
  ASSERT_THAT(tallies, ElementsAre(Pair("_other", _), Pair("north", _)));
  EXPECT_EQ(tallies.at("north").here.offline, 1);
  EXPECT_EQ(tallies.at("north").elsewhere.online, 1);
  EXPECT_EQ(tallies.at("_other").here.offline, 1);
}

TEST_F(FleetTest, SweepCountsCertificatesThatExpireSoonWhileTheirRobotsAreConnected) {
  Fleet fleet(clock_, 100, {});
  const auto connect = [&](const std::string& ruri, milliseconds valid) {
    storage::ConnectionItem item;
    item.certificate.not_after = clock_.System() + valid;
    Admit(fleet, ruri).agent.Begin(item);
  };
  const auto expiring = [&] {
    fleet.Sweep(kIdle);
    return fleet.fleet_tallies().at("north").certificates_expiring;
  };
  connect("rcan://new", kCertificateExpiring);
  EXPECT_EQ(expiring(), 0) << "at the limit";
  connect("rcan://old", kCertificateExpiring - milliseconds(1));
  EXPECT_EQ(expiring(), 1);
  fleet.Find("rcan://old")->agent.End({});
  EXPECT_EQ(expiring(), 0);
}

TEST_F(FleetTest, SweepCountsRobotsThatAreParked) {
  Fleet fleet(clock_, 100, {});
  Admit(fleet, "rcan://parked")
      .state.Park(clock_.System() + std::chrono::hours(1), clock_.Steady());
  Admit(fleet, "rcan://gone");
  clock_.Advance(fleet.presence_limits().startup_grace + milliseconds(1));
  const PresenceCounts counts = fleet.Sweep(kIdle);
  EXPECT_EQ(counts.offline, 2);
  EXPECT_EQ(counts.parked, 1);
  metrics::Exposition page;
  AddSamples(fleet, page);
  EXPECT_THAT(page.Text(), HasSubstr("uplinkd_robots{fleet=\"north\",presence=\"offline\"} 1\n"));
  EXPECT_THAT(page.Text(), HasSubstr("uplinkd_robots{fleet=\"north\",presence=\"parked\"} 1\n"));
  EXPECT_THAT(page.Text(), HasSubstr("uplinkd_robots_flapping{fleet=\"north\"} 0\n"));
}

TEST_F(FleetTest, TheGraceOfAStartBeginsWhenRobotsCanConnect) {
  Fleet fleet(clock_, 100, {});
  Admit(fleet, "rcan://stored");
  clock_.Advance(fleet.presence_limits().startup_grace * 2);  // the store is slow to answer
  fleet.BeginListening();
  EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1);
  Admit(fleet, "rcan://came");
  for (milliseconds passed{0}; passed < fleet.presence_limits().startup_grace;
       passed += seconds(1)) {
    clock_.Advance(seconds(1));
    EXPECT_EQ(fleet.Sweep(kIdle).unknown, 2) << passed.count();
  }
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(fleet.Sweep(kIdle).offline, 2);
}

TEST_F(FleetTest, WithoutAGraceARobotIsSilentOnlySinceItCouldConnect) {
  Fleet fleet(clock_, 100, {.timeout = seconds(10), .startup_grace = seconds(0)});
  Admit(fleet, "rcan://stored");
  clock_.Advance(seconds(60));
  fleet.BeginListening();
  clock_.Advance(seconds(2));
  EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1);
  clock_.Advance(seconds(3));
  EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1);
}

TEST_F(FleetTest, ARobotThatIsNewHasATimeoutToBeHeard) {
  Fleet fleet(clock_, 100, {});
  clock_.Advance(fleet.presence_limits().startup_grace + milliseconds(1));
  Admit(fleet, "rcan://late");
  EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1) << "between its Hello and its first message";
  clock_.Advance(seconds(2));
  EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1);
  for (int i = 0; i < 4; ++i) {
    clock_.Advance(seconds(2));
    EXPECT_EQ(fleet.Sweep(kIdle).unknown, 1) << i;
  }
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(fleet.Sweep(kIdle).offline, 1);
}

TEST_F(FleetTest, AfterAStandstillOfTheServerNobodyIsOfflineBeforeItCouldBeHeard) {
  Fleet fleet(clock_, 100, {});
  robot::Robot& heard = Admit(fleet, "rcan://heard");
  robot::Robot& gone = Admit(fleet, "rcan://gone");
  const robot::PresenceLimits& limits = fleet.presence_limits();
  robot::Robot& offline = Admit(fleet, "rcan://offline");
  offline.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  clock_.Advance(limits.timeout + milliseconds(1));
  fleet.Sweep(kIdle);
  ASSERT_EQ(offline.state.presence(), robot::Presence::kOffline);
  clock_.Advance(seconds(1));
  heard.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  gone.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  EXPECT_EQ(fleet.Sweep(kIdle).online, 2);
  clock_.Advance(Fleet::kStandstillBreaks - milliseconds(1));
  EXPECT_EQ(fleet.Sweep(kIdle).online, 2) << "what lies unread comes first";
  heard.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  clock_.Advance(seconds(1));
  EXPECT_EQ(fleet.Sweep(kIdle).online, 1);
  EXPECT_EQ(gone.state.presence(), robot::Presence::kUnknown);
  EXPECT_EQ(offline.state.presence(), robot::Presence::kOffline) << "its silence was proven before";
  for (int i = 0; i < 3; ++i) {
    clock_.Advance(Fleet::kSweepLate);
    fleet.Sweep(kIdle);
  }
  EXPECT_EQ(gone.state.presence(), robot::Presence::kUnknown) << "a timeout after the standstill";
  clock_.Advance(seconds(1));
  fleet.Sweep(kIdle);
  EXPECT_EQ(gone.state.presence(), robot::Presence::kOffline);
}

/// A robot of the relay and a twin that are heard, beside one that is offline.
class LongStandstill : public FleetTest {
 protected:
  LongStandstill() {
    for (robot::Robot* const robot : heard_) Hear(*robot);
    Hear(offline_);
    PassSweeping(seconds(30));
    EXPECT_EQ(offline_.state.presence(), robot::Presence::kOffline);
    for (robot::Robot* const robot : heard_) Hear(*robot);
    fleet_.Sweep(kIdle);
  }
  void Hear(robot::Robot& robot) {
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits_of(robot));
  }
  void PassSweeping(milliseconds time) {
    for (milliseconds passed{0}; passed < time; passed += seconds(1)) {
      clock_.Advance(std::min<milliseconds>(seconds(1), time - passed));
      fleet_.Sweep(kIdle);
    }
  }
  /// The standstill has just ended, and what lay unread in the sockets of connections that broke
  /// meanwhile is read.
  void ExpectGraceAnew() {
    fleet_.Sweep(kIdle);
    EXPECT_TRUE(fleet_.stood_still());
    for (robot::Robot* const robot : heard_) Hear(*robot);
    PassSweeping(kLimits.startup_grace);
    for (const robot::Robot* const robot : heard_) {
      EXPECT_EQ(robot->state.presence(), robot::Presence::kUnknown) << robot->ruri();
    }
    EXPECT_EQ(offline_.state.presence(), robot::Presence::kOffline) << "it was proven before";
    PassSweeping(milliseconds(1));
    for (const robot::Robot* const robot : heard_) {
      EXPECT_EQ(robot->state.presence(), robot::Presence::kOffline) << robot->ruri();
    }
  }

  static constexpr robot::PresenceLimits kLimits{.timeout = seconds(10),
                                                 .startup_grace = seconds(120)};
  static constexpr robot::PresenceLimits kTwins{.timeout = seconds(20),
                                                .startup_grace = seconds(120)};
  testing::ManualBootClock boot_{clock_};
  Fleet fleet_{clock_, 100, kLimits, kTwins, &boot_};
  robot::Robot& offline_ = Admit(fleet_, "rcan://offline");
  const std::vector<robot::Robot*> heard_{&Admit(fleet_, "rcan://heard"), &Admit(fleet_, kTwin)};
};

TEST_F(LongStandstill, BeginsTheGraceOfAStartAnew) {
  clock_.Advance(std::chrono::minutes(7));
  ExpectGraceAnew();
}

TEST_F(LongStandstill, BeginsWhereConnectionsMayBreak) {
  clock_.Advance(Fleet::kStandstillBreaks);
  ExpectGraceAnew();
}

TEST_F(LongStandstill, IsNoneBelowThat) {
  clock_.Advance(Fleet::kStandstillBreaks - milliseconds(1));
  fleet_.Sweep(kIdle);
  PassSweeping(kTwins.timeout + milliseconds(1));
  for (const robot::Robot* const robot : heard_) {
    EXPECT_EQ(robot->state.presence(), robot::Presence::kOffline) << robot->ruri();
  }
}

TEST_F(LongStandstill, IsASuspendTooThoughTheMonotonicClockStandsStill) {
  clock_.Advance(seconds(1));
  boot_.Suspend(std::chrono::minutes(7));
  ExpectGraceAnew();
}

TEST_F(LongStandstill, WhoIsHeardAfterItIsOnlineAtOnce) {
  clock_.Advance(std::chrono::minutes(7));
  fleet_.Sweep(kIdle);
  PassSweeping(seconds(30));
  Hear(*heard_[0]);
  PassSweeping(seconds(1));
  EXPECT_EQ(heard_[0]->state.presence(), robot::Presence::kOnline);
}

TEST_F(FleetTest, WhileTheServerIsBehindNobodyBecomesOffline) {
  using enum Fleet::HearingState;
  Fleet fleet(clock_, 100, {});
  const robot::PresenceLimits& limits = fleet.presence_limits();
  robot::Robot& gone = Admit(fleet, "rcan://gone");
  gone.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  clock_.Advance(limits.timeout + milliseconds(1));
  robot::Robot& heard = Admit(fleet, "rcan://heard");
  robot::Robot& waiting = Admit(fleet, "rcan://waiting");
  heard.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  waiting.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  const auto sweep = [&](Fleet::HearingState hearing, milliseconds in) {
    for (milliseconds left = in; left > milliseconds(0); left -= seconds(1)) {
      clock_.Advance(std::min<milliseconds>(left, seconds(1)));
      fleet.Sweep(kIdle, hearing);
    }
  };
  fleet.Sweep(kIdle, kUpToDate);
  ASSERT_EQ(gone.state.presence(), robot::Presence::kOffline);

  sweep(kBehind, limits.timeout);
  EXPECT_EQ(waiting.state.presence(), robot::Presence::kOnline) << "within the limit";
  heard.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  sweep(kBehind, milliseconds(1));
  EXPECT_EQ(heard.state.presence(), robot::Presence::kOnline) << "it was read after all";
  EXPECT_EQ(waiting.state.presence(), robot::Presence::kUnknown);
  EXPECT_EQ(gone.state.presence(), robot::Presence::kOffline) << "its silence was proven before";

  sweep(kUpToDate, limits.timeout);
  EXPECT_EQ(waiting.state.presence(), robot::Presence::kUnknown) << "a timeout to be heard";
  EXPECT_EQ(gone.state.presence(), robot::Presence::kOffline);
  sweep(kUpToDate, milliseconds(1));
  EXPECT_EQ(waiting.state.presence(), robot::Presence::kOffline);
}

TEST_F(FleetTest, SilenceBeforeTheStoreWasReplacedMakesNobodyOffline) {
  Fleet fleet(clock_, 100, {});
  const robot::PresenceLimits& limits = fleet.presence_limits();
  robot::Robot& robot = Admit(fleet, "rcan://a");
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), limits);
  const auto sweep = [&](milliseconds in) {
    for (milliseconds left = in; left > milliseconds(0); left -= seconds(1)) {
      clock_.Advance(std::min<milliseconds>(left, seconds(1)));
      fleet.Sweep(kIdle);
    }
  };
  fleet.Sweep(kIdle);
  sweep(limits.timeout);
  fleet.NoteStoreReplaced();
  sweep(Fleet::kReplacedKnown + limits.timeout);
  EXPECT_EQ(robot.state.presence(), robot::Presence::kUnknown) << "a timeout to be heard";
  sweep(milliseconds(1));
  EXPECT_EQ(robot.state.presence(), robot::Presence::kOffline);
}

TEST_F(FleetTest, WhoBecameOfflineWhileTheStoreWasReplacedIsUnknown) {
  Fleet fleet(clock_, 100, {});
  const milliseconds timeout = fleet.presence_limits().timeout;
  robot::Robot& before = Admit(fleet, "rcan://before");
  robot::Robot& meanwhile = Admit(fleet, "rcan://meanwhile");
  const auto hear = [&](robot::Robot& robot) {
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits());
  };
  const auto sweep = [&](milliseconds in) {
    for (const SteadyTime end = clock_.Steady() + in; clock_.Steady() < end;) {
      clock_.Advance(std::min<milliseconds>(
          seconds(1), std::chrono::ceil<milliseconds>(end - clock_.Steady())));
      fleet.Sweep(kIdle);
    }
  };
  fleet.Sweep(kIdle);
  hear(before);
  sweep(seconds(2));
  hear(meanwhile);
  sweep(timeout);
  fleet.NoteStoreLooked(clock_.Steady());
  ASSERT_EQ(before.state.presence(), robot::Presence::kOffline);
  ASSERT_EQ(meanwhile.state.presence(), robot::Presence::kOnline);
  sweep(milliseconds(1));
  ASSERT_EQ(meanwhile.state.presence(), robot::Presence::kOffline);
  fleet.NoteStoreReplaced();
  EXPECT_EQ(meanwhile.state.presence(), robot::Presence::kUnknown);
  EXPECT_EQ(before.state.presence(), robot::Presence::kOffline);
  sweep(Fleet::kReplacedKnown + timeout);
  EXPECT_EQ(meanwhile.state.presence(), robot::Presence::kUnknown) << "a timeout to be heard";
  sweep(milliseconds(1));
  EXPECT_EQ(meanwhile.state.presence(), robot::Presence::kOffline);
}

TEST_F(FleetTest, TheRuriSaysByWhichWayARobotIsHeard) {
  Fleet fleet(clock_, 100, {});
  using enum model::MessageSource;
  EXPECT_EQ(Admit(fleet, kTwin).source(), kCyberwave);
  EXPECT_EQ(Admit(fleet, "rcan://local.rcan/cyberwave/sim.site/T").source(), kCyberwave);
  EXPECT_EQ(Admit(fleet, storage::NoRobotOf("site/")).source(), kCyberwave);
  EXPECT_EQ(Admit(fleet, "rcan://local.rcan/cyberwave/arm/1").source(), kUplink);
  EXPECT_EQ(Admit(fleet, "rcan://a").source(), kUplink);
}

TEST_F(FleetTest, ATwinIsJudgedByItsOwnTimeout) {
  Fleet fleet(clock_, 100, {.timeout = seconds(10)}, {.timeout = seconds(20)});
  robot::Robot& relay = Admit(fleet, "rcan://a");
  robot::Robot& twin = Admit(fleet, kTwin);
  EXPECT_EQ(fleet.presence_limits_of(relay).timeout, seconds(10));
  EXPECT_EQ(fleet.presence_limits_of(twin).timeout, seconds(20));
  for (robot::Robot* robot : {&relay, &twin}) {
    robot->state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits_of(*robot));
  }
  const auto sweep_until = [this, &fleet, began = clock_.Steady()](milliseconds at) {
    while (clock_.Steady() - began < at) {
      clock_.Advance(std::min<milliseconds>(
          seconds(1), at - std::chrono::duration_cast<milliseconds>(clock_.Steady() - began)));
      fleet.Sweep(kIdle);
    }
  };
  sweep_until(seconds(10));
  EXPECT_EQ(relay.state.presence(), robot::Presence::kOnline);
  sweep_until(milliseconds(10'001));
  EXPECT_EQ(relay.state.presence(), robot::Presence::kOffline);
  sweep_until(seconds(19));
  EXPECT_EQ(twin.state.presence(), robot::Presence::kOnline);
  sweep_until(seconds(20));
  EXPECT_EQ(twin.state.presence(), robot::Presence::kOnline) << "at its timeout";
  sweep_until(milliseconds(20'001));
  EXPECT_EQ(twin.state.presence(), robot::Presence::kOffline);
  twin.state.SignOfLife(clock_.Steady(), clock_.System(), fleet.presence_limits_of(twin));
  EXPECT_EQ(twin.state.presence(), robot::Presence::kOnline);
}

TEST_F(FleetTest, WhatTheRelayHearsSaysNothingOfTwinsNorTheOtherWayRound) {
  using enum Fleet::HearingState;
  struct Case {
    Fleet::HearingState relay;
    Fleet::HearingState twins;
    robot::Presence of_relay;
    robot::Presence of_twin;
  };
  constexpr auto kUnknown = robot::Presence::kUnknown;
  constexpr auto kOffline = robot::Presence::kOffline;
  for (const Case& each :
       {Case{kUpToDate, kUpToDate, kOffline, kOffline},
        Case{kUpToDate, kBehind, kOffline, kUnknown}, Case{kBehind, kUpToDate, kUnknown, kOffline},
        Case{kHereAlone, kUpToDate, kUnknown, kOffline},
        // A twin never has a stream, and so none shows that it is here.
        Case{kUpToDate, kHereAlone, kOffline, kUnknown},
        Case{kBehind, kBehind, kUnknown, kUnknown}}) {
    Fleet fleet(clock_, 100, {.startup_grace = seconds(0)}, {.startup_grace = seconds(0)});
    robot::Robot& relay = Admit(fleet, "rcan://a");
    robot::Robot& twin = Admit(fleet, kTwin);
    for (int passed = 0; passed < 60; ++passed) {
      clock_.Advance(seconds(1));
      fleet.Sweep(kIdle, each.relay, each.twins);
    }
    EXPECT_EQ(relay.state.presence(), each.of_relay);
    EXPECT_EQ(twin.state.presence(), each.of_twin);
  }
}

TEST_F(FleetTest, SweepForgetsIdleSessions) {
  Fleet fleet(clock_, 100, {});
  robot::RobotSessions& sessions = Admit(fleet, "rcan://a").sessions;
  ASSERT_TRUE(sessions.Begin(model::SessionId(), clock_.Steady()));
  clock_.Advance(kIdle);
  fleet.Sweep(kIdle);
  EXPECT_EQ(sessions.Held().size(), 1U);
  clock_.Advance(milliseconds(1));
  fleet.Sweep(kIdle);
  EXPECT_TRUE(sessions.Held().empty());
}

}  // namespace
}  // namespace uplink::fleet
