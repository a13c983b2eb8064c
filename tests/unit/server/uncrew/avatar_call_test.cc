#include "server/uncrew/avatar_call.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/uncrew/limits.h"
#include "tests/support/fake_reader.h"
#include "tests/unit/server/uncrew/avatar_bench.h"

namespace uplink::uncrew {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kText = "metadata { sampled_at_unix_us: 7 } status_text { text: \"a\" }";
constexpr std::string_view kRequest =
    "operator_action_requests { requests { request_id: \"r\" confirm_delivery_ready {} } }";

class AvatarCallTest : public ::testing::Test {
 protected:
  /// The drone is claimed.
  void Begin() {
    static_cast<void>(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }"));
    bench_.Commit();
  }
  /// What comes of a sample that is sent and committed.
  std::string Committed(SampleType type, std::string_view text) {
    FakeCall& call = bench_.Call(type, text);
    bench_.Commit();
    return call.End();
  }
  [[nodiscard]] std::size_t OpenRequests() {
    std::size_t open = 0;
    for (const DronePtr& drone : bench_.drones().All()) {
      drone->LookAt([&](const LiveSamples& live) { open += live.requests().size(); });
    }
    return open;
  }

  static std::string ModeText(std::string_view at, std::string_view name) {
    return "metadata { sampled_at_unix_us: " + std::string(at) +
           " } flight_mode { mode: FLIGHT_MODE_" + std::string(name) + " }";
  }
  /// What comes of a mode that is sent and committed.
  static std::string Mode(AvatarBench& bench, std::string_view at, std::string_view name) {
    FakeCall& call = bench.Call(SampleType::kFlightMode, ModeText(at, name));
    bench.Commit();
    return call.End();
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  AvatarBench bench_{clock_, database_, 1};
};

TEST_F(AvatarCallTest, ALiveSampleIsAnsweredAtOnceWhateverTheStoreDoes) {
  bench_.store().Break();
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }").End(), "APPLIED");
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 2 }").End(), "APPLIED");
}

TEST_F(AvatarCallTest, ALiveSampleThatIsSentAgainIsSuperseded) {
  const std::string_view text = "metadata { sampled_at_boot_us: 5 } heading { heading_deg: 1 }";
  EXPECT_EQ(bench_.Call(SampleType::kHeading, text).End(), "APPLIED");
  EXPECT_EQ(bench_.Call(SampleType::kHeading, text).End(), "SUPERSEDED");
}

TEST_F(AvatarCallTest, AnOlderSampleIsSupersededUnlessTheDroneRebooted) {
  const auto at = [&](std::string_view seconds) {
    return bench_
        .Call(SampleType::kHeading, "metadata { sampled_at_boot_us: " + std::string(seconds) +
                                        "000000 } heading { heading_deg: 1 }")
        .End();
  };
  EXPECT_EQ(at("100"), "APPLIED");
  EXPECT_EQ(at("99"), "SUPERSEDED");
  EXPECT_EQ(at("40"), "SUPERSEDED");
  EXPECT_EQ(at("39"), "APPLIED");
}

TEST_F(AvatarCallTest, ADurableSampleIsAnsweredOnceItIsCommitted) {
  FakeCall& call = bench_.Call(SampleType::kStatusText, kText);
  EXPECT_EQ(call.End(), "waits");
  bench_.Commit();
  EXPECT_EQ(call.End(), "STORED");
  EXPECT_EQ(bench_.counts().stored, 1U);
  EXPECT_TRUE(bench_.counts().Balanced());
  EXPECT_EQ(bench_.counts().in_flight, 0);
}

TEST_F(AvatarCallTest, ADurableSampleThatIsSentAgainIsADuplicateWhereverItComes) {
  static_cast<void>(bench_.Call(SampleType::kStatusText, kText));
  // While the first waits, too.
  FakeCall& again = bench_.Call(SampleType::kStatusText, kText);
  EXPECT_EQ(again.End(), "waits");
  bench_.Commit();
  EXPECT_EQ(again.End(), "DUPLICATE");
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "DUPLICATE");

  AvatarBench elsewhere(clock_, database_, 2);
  FakeCall& there = elsewhere.Call(SampleType::kStatusText, kText);
  elsewhere.Commit();
  EXPECT_EQ(there.End(), "DUPLICATE");
}

TEST_F(AvatarCallTest, ADuplicateIsToldOnceTheStoreHasCommittedAnew) {
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "STORED");
  FakeCall& first = bench_.Call(SampleType::kStatusText, kText);
  FakeCall& second = bench_.Call(SampleType::kStatusText, kText);
  EXPECT_EQ(first.End(), "waits");
  EXPECT_EQ(second.End(), "waits");
  bench_.Commit();
  EXPECT_EQ(first.End(), "DUPLICATE");
  EXPECT_EQ(second.End(), "DUPLICATE");
}

TEST_F(AvatarCallTest, ADuplicateIsUnavailableWhileTheStoreIsAway) {
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "STORED");
  bench_.store().FailNextCommits(1'000, testing::FailAt::kBefore);
  FakeCall& again = bench_.Call(SampleType::kStatusText, kText);
  bench_.Advance();
  bench_.Pass(std::chrono::seconds(5));
  EXPECT_EQ(again.End(), "UNAVAILABLE");
  EXPECT_TRUE(bench_.counts().Balanced());
}

TEST_F(AvatarCallTest, ASampleThatAnOlderStoreLacksIsStoredWhenItIsSentAgain) {
  Begin();
  testing::FakeDatabase older;
  older.CopyRowsOf(database_);
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "STORED");
  EXPECT_EQ(Committed(SampleType::kOperatorRequests, kRequest), "STORED");
  database_.CopyRowsOf(older);
  FakeCall& text = bench_.Call(SampleType::kStatusText, kText);
  FakeCall& set = bench_.Call(SampleType::kOperatorRequests,
                              "metadata { sampled_at_unix_us: 9 } " + std::string(kRequest));
  bench_.store().Break();
  bench_.Commit();
  EXPECT_EQ(text.End(), "STORED");
  EXPECT_EQ(set.End(), "STORED");
  EXPECT_TRUE(bench_.counts().Balanced());
}

TEST_F(AvatarCallTest, ADroneThatAlternatesLosesNothing) {
  AvatarBench elsewhere(clock_, database_, 2);
  for (int i = 0; i < 3; ++i) {
    for (AvatarBench* bench : {&bench_, &elsewhere}) {
      const std::string text = "metadata { sampled_at_unix_us: " + std::to_string(i) +
                               (bench == &bench_ ? "1" : "2") + " } status_text { text: \"a\" }";
      FakeCall& call = bench->Call(SampleType::kStatusText, text);
      bench->Commit();
      EXPECT_EQ(call.End(), "STORED") << text;
    }
  }
}

TEST_F(AvatarCallTest, WithoutACommitItIsUnavailableInTimeAndStillCommits) {
  Begin();
  FakeCall& call = bench_.Call(SampleType::kStatusText, kText);
  bench_.Pass(std::chrono::seconds(4));
  EXPECT_EQ(call.End(), "waits");
  bench_.Pass(std::chrono::seconds(1));
  EXPECT_EQ(call.End(), "UNAVAILABLE");
  bench_.Commit();
  EXPECT_EQ(bench_.counts().stored, 1U);
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "DUPLICATE");
}

TEST_F(AvatarCallTest, WhatWasTakenCommitsAlsoOnceTheStoreIsConnectedToAnew) {
  Begin();
  FakeCall& call = bench_.Call(SampleType::kStatusText, kText);
  FakeCall& set = bench_.Call(SampleType::kOperatorRequests, kRequest);
  bench_.store().Break();
  bench_.Advance();
  bench_.Pass(std::chrono::seconds(5));
  EXPECT_EQ(call.End(), "UNAVAILABLE");
  EXPECT_EQ(set.End(), "UNAVAILABLE");
  bench_.Commit();
  EXPECT_EQ(bench_.counts().stored, 2U);
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "DUPLICATE");
  EXPECT_EQ(Committed(SampleType::kOperatorRequests,
                      "metadata { sampled_at_unix_us: 9 } " + std::string(kRequest)),
            "SUPERSEDED");
}

TEST_F(AvatarCallTest, ARequestThatDoesNotComeWholeEndsInTimeAndAtADrain) {
  FakeCall& late = bench_.CallWithoutRequest();
  bench_.Pass(std::chrono::milliseconds(4'999));
  EXPECT_EQ(late.End(), "waits");
  bench_.Pass(std::chrono::milliseconds(1));
  EXPECT_EQ(late.End(), "DEADLINE_EXCEEDED");
  EXPECT_THAT(std::string(late.status().message()), HasSubstr("uncrew.answer_within"));
  FakeCall& drained = bench_.CallWithoutRequest();
  bench_.Drain(std::chrono::seconds(2));
  EXPECT_EQ(drained.End(), "UNAVAILABLE");
}

TEST_F(AvatarCallTest, ADroneThatIsToBeForgottenMayCallAgainOnceThatIsOver) {
  Begin();
  const fleet::RobotPtr robot = bench_.fleet().Find(AvatarBench::Drone("1").ruri);
  robot->calls.AskToEnd(clock_.Steady() + std::chrono::seconds(5));
  bench_.drones().Round();
  EXPECT_EQ(bench_.drones().size(), 0U);
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }").End(), "UNAVAILABLE");
  EXPECT_EQ(bench_.drones().size(), 0U) << "else it could never be forgotten";
  clock_.Advance(std::chrono::seconds(5));
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }").End(), "APPLIED");
}

TEST_F(AvatarCallTest, ADroneIsMovedToItsNewFleetAlsoIfSomethingOfItWaited) {
  Begin();
  FakeCall& waits = bench_.Call(SampleType::kStatusText, kText);
  identity::PeerIdentity moved = AvatarBench::Drone("1");
  moved.fleet = "other";
  static_cast<void>(
      bench_.CallBytes(moved, SampleType::kHeading,
                       test::RequestOf(SampleType::kHeading, "heading { heading_deg: 2 }")));
  bench_.Commit();
  EXPECT_EQ(waits.End(), "STORED");
  static_cast<void>(
      bench_.CallBytes(moved, SampleType::kHeading,
                       test::RequestOf(SampleType::kHeading, "heading { heading_deg: 3 }")));
  bench_.Commit();
  testing::FakeReader reader(database_);
  const auto robots = reader.Robots(1);
  ASSERT_TRUE(robots.ok());
  EXPECT_EQ(robots->front().robot.fleet, "other");
}

TEST_F(AvatarCallTest, AnAuthorityMovesADroneOutOfItsOwnFleetsAlone) {
  Begin();
  FakeCall& waits = bench_.Call(SampleType::kStatusText, kText);
  const auto call = [this](std::vector<std::string> fleets) -> FakeCall& {
    identity::PeerIdentity moved = AvatarBench::Drone("1");
    moved.fleet = "other";
    moved.bounds = std::make_shared<const identity::FleetBounds>(identity::FleetBounds{
        .authority = "guests", .fleets = identity::Scope::Of(std::move(fleets))});
    return bench_.CallBytes(moved, SampleType::kHeading,
                            test::RequestOf(SampleType::kHeading, "heading { heading_deg: 2 }"));
  };
  const std::string fleet = AvatarBench::Drone("1").fleet;
  const fleet::RobotPtr robot = bench_.fleet().Find(AvatarBench::Drone("1").ruri);
  EXPECT_EQ(call({"other"}).End(), "PERMISSION_DENIED");
  EXPECT_EQ(robot->id()->fleet, fleet);
  static_cast<void>(call({"other", fleet}));
  bench_.Commit();
  EXPECT_EQ(waits.End(), "STORED");
  static_cast<void>(call({"other", fleet}));
  bench_.Commit();
  testing::FakeReader reader(database_);
  const auto robots = reader.Robots(1);
  ASSERT_TRUE(robots.ok());
  EXPECT_EQ(robots->front().robot.fleet, "other");
}

TEST_F(AvatarCallTest, WithoutACommitADrainAnswersItWithinItsGrace) {
  Begin();
  FakeCall& call = bench_.Call(SampleType::kStatusText, kText);
  bench_.Drain(std::chrono::seconds(2));
  bench_.Pass(std::chrono::milliseconds(1'999));
  EXPECT_EQ(call.End(), "waits");
  bench_.Pass(std::chrono::milliseconds(1));
  EXPECT_EQ(call.End(), "UNAVAILABLE");
  bench_.Commit();
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "DUPLICATE");
}

TEST_F(AvatarCallTest, ARequestThatIsTooLargeNamesItsSizeAndTheLimit) {
  FakeCall& call = bench_.CallTooLarge(kRequestBytesMax + 1);
  EXPECT_EQ(call.End(), "RESOURCE_EXHAUSTED");
  EXPECT_EQ(call.status().message(), "the request has 65537 bytes, the limit is 65536");
  EXPECT_EQ(bench_.drones().size(), 0U);
}

TEST_F(AvatarCallTest, AnUnclaimedDroneWaitsForNoLonger) {
  FakeCall& call = bench_.Call(SampleType::kStatusText, kText);
  bench_.Pass(std::chrono::seconds(5));
  EXPECT_EQ(call.End(), "UNAVAILABLE");
  EXPECT_EQ(bench_.counts().refused, 1U);
  EXPECT_TRUE(bench_.counts().Balanced());
  EXPECT_EQ(bench_.counts().in_flight, 0);
}

TEST_F(AvatarCallTest, AChangeIsStoredAndARepetitionIsLive) {
  EXPECT_EQ(Mode(bench_, "1", "HOLD"), "STORED");
  EXPECT_EQ(Mode(bench_, "2", "HOLD"), "APPLIED");
  EXPECT_EQ(Mode(bench_, "3", "LAND"), "STORED");
  EXPECT_EQ(Mode(bench_, "4", "LAND"), "APPLIED");
  EXPECT_EQ(bench_.counts().stored, 2U);
  EXPECT_EQ(bench_.counts().applied, 2U);
  EXPECT_TRUE(bench_.counts().Balanced());
}

TEST_F(AvatarCallTest, WhatSaysTheSameAsBeforeIsAChangeIfAnotherServerStoredSince) {
  AvatarBench elsewhere(clock_, database_, 2);
  EXPECT_EQ(Mode(bench_, "1", "HOLD"), "STORED");
  EXPECT_EQ(Mode(elsewhere, "2", "LAND"), "STORED");
  EXPECT_EQ(Mode(bench_, "3", "HOLD"), "STORED");

  EXPECT_EQ(Committed(SampleType::kOperatorRequests, kRequest), "STORED");
  FakeCall& none = elsewhere.Call(SampleType::kOperatorRequests, "operator_action_requests {}");
  elsewhere.Commit();
  EXPECT_EQ(none.End(), "STORED");
  EXPECT_EQ(Committed(SampleType::kOperatorRequests,
                      "metadata { sampled_at_unix_us: 9 } " + std::string(kRequest)),
            "STORED");
}

TEST_F(AvatarCallTest, AChangeThatAnotherServersClaimFencedIsJudgedAnew) {
  AvatarBench elsewhere(clock_, database_, 2);
  EXPECT_EQ(Mode(bench_, "1", "HOLD"), "STORED");
  EXPECT_EQ(Mode(elsewhere, "2", "LAND"), "STORED");
  EXPECT_EQ(Mode(bench_, "2", "LAND"), "DUPLICATE");
  EXPECT_EQ(Mode(elsewhere, "3", "TAKEOFF"), "STORED");
  EXPECT_EQ(Mode(bench_, "4", "HOLD"), "STORED");
  EXPECT_EQ(bench_.counts().stored + elsewhere.counts().stored, 4U);
}

TEST_F(AvatarCallTest, RequestsAreShownAtOnceAndEndWithTheSet) {
  bench_.store().Break();
  static_cast<void>(bench_.Call(SampleType::kOperatorRequests, kRequest));
  EXPECT_EQ(OpenRequests(), 1U);
  static_cast<void>(bench_.Call(SampleType::kOperatorRequests, "operator_action_requests {}"));
  EXPECT_EQ(OpenRequests(), 0U);
}

TEST_F(AvatarCallTest, ASetThatSaysTheSameIsSupersededOnceTheFirstIsCommitted) {
  Begin();
  FakeCall& first = bench_.Call(SampleType::kOperatorRequests, kRequest);
  FakeCall& same = bench_.Call(SampleType::kOperatorRequests,
                               "metadata { sampled_at_unix_us: 9 } " + std::string(kRequest));
  EXPECT_EQ(same.End(), "waits");
  bench_.Commit();
  EXPECT_EQ(first.End(), "STORED");
  EXPECT_EQ(same.End(), "SUPERSEDED");
}

TEST_F(AvatarCallTest, ASetWithoutItsMessageClearsNothing) {
  FakeCall& first = bench_.Call(SampleType::kOperatorRequests, kRequest);
  bench_.Commit();
  EXPECT_EQ(first.End(), "STORED");
  FakeCall& call = bench_.Call(SampleType::kOperatorRequests, "");
  bench_.Commit();
  EXPECT_EQ(call.End(), "REJECTED");
  EXPECT_EQ(call.response().reason(), v1::REJECT_REASON_MISSING_FIELD);
  EXPECT_EQ(OpenRequests(), 1U);
}

TEST_F(AvatarCallTest, ABadSensorIsNoLostLinkWhileTheStoreIsAway) {
  Begin();
  const std::string_view bad = "battery { remaining_percent: 200 }";
  EXPECT_EQ(bench_.Call(SampleType::kBattery, bad).End(), "REJECTED");
  EXPECT_EQ(bench_.Call(SampleType::kBattery, bad).End(), "REJECTED");
  EXPECT_EQ(bench_.counts().rejected, 0U) << "its row waits";
  bench_.Commit();
  EXPECT_EQ(bench_.counts().rejected, 1U);
  EXPECT_TRUE(bench_.counts().Balanced());
}

TEST_F(AvatarCallTest, BadContentIsAnAnswerAndKeptOnce) {
  const std::string_view bad = "battery { remaining_percent: 200 }";
  FakeCall& call = bench_.Call(SampleType::kBattery, bad);
  bench_.Commit();
  EXPECT_EQ(call.End(), "REJECTED");
  EXPECT_EQ(call.response().field(), "battery.remaining_percent");
  EXPECT_EQ(Committed(SampleType::kBattery, bad), "REJECTED");
  EXPECT_EQ(bench_.counts().rejected, 1U);
  EXPECT_EQ(bench_.counts().duplicate, 1U);
}

TEST_F(AvatarCallTest, TooManyLiveSamplesAreRateLimitedAndDurableOnesAreNot) {
  Begin();
  std::string last;
  for (std::uint64_t i = 0; i <= kLiveRate.burst; ++i) {
    FakeCall& call = bench_.Call(SampleType::kHeading,
                                 "metadata { sampled_at_unix_us: " + std::to_string(i + 1) +
                                     " } heading { heading_deg: 2 }");
    last = call.End();
    if (last == "REJECTED") {
      EXPECT_EQ(call.response().reason(), v1::REJECT_REASON_RATE_LIMITED);
      EXPECT_GT(call.response().retry_after_ms(), 0);
    }
  }
  EXPECT_EQ(last, "REJECTED");
  FakeCall& durable = bench_.Call(SampleType::kStatusText, kText);
  bench_.Commit();
  EXPECT_EQ(durable.End(), "STORED");
  EXPECT_TRUE(bench_.counts().Balanced());
}

TEST_F(AvatarCallTest, The65thCallOfADroneIsOneTooMany) {
  for (std::size_t i = 0; i < kCallsInFlightMax; ++i) {
    const std::string text = "metadata { sampled_at_unix_us: " + std::to_string(i + 1) +
                             " } status_text { text: \"a\" }";
    ASSERT_EQ(bench_.Call(SampleType::kStatusText, text).End(), "waits");
  }
  FakeCall& one_more = bench_.Call(SampleType::kStatusText, kText);
  EXPECT_EQ(one_more.End(), "RESOURCE_EXHAUSTED");
  FakeCall& other =
      bench_.CallBytes(AvatarBench::Drone("2"), SampleType::kHeading,
                       test::RequestOf(SampleType::kHeading, "heading { heading_deg: 1 }"));
  EXPECT_EQ(other.End(), "APPLIED");
  bench_.Commit();
  EXPECT_EQ(bench_.counts().stored, kCallsInFlightMax);
}

TEST_F(AvatarCallTest, AForeignIdIsNoneOfTheCertificates) {
  FakeCall& call =
      bench_.Call(SampleType::kHeading, "metadata { uav_id: \"2\" } heading { heading_deg: 1 }");
  EXPECT_EQ(call.End(), "PERMISSION_DENIED");
  EXPECT_THAT(std::string(call.status().message()), HasSubstr("metadata.uav_id 2"));
  EXPECT_EQ(bench_.drones().size(), 0U);
}

TEST_F(AvatarCallTest, NoCommandsAreRelayedAndTheDroneIsToldSo) {
  FakeCall call(AvatarBench::Drone("1"), {});
  const auto served =
      bench_.methods().at("/uncrew.v1.AvatarService/SubscribeUAVCommands").serve(call);
  EXPECT_EQ(served.status(), absl::UnimplementedError("this server relays no commands"));
}

TEST_F(AvatarCallTest, ABlockedDroneIsRefusedAlsoWhereItsSampleWaits) {
  fleet::RobotSettings settings(1);
  settings.OnChange([this](std::span<const fleet::RobotSettings::Change> changes) {
    bench_.fleet().OnSettings(changes);
  });
  bench_.fleet().entry().Set({}, settings);
  FakeCall& waits = bench_.Call(SampleType::kStatusText, kText);
  EXPECT_EQ(waits.End(), "waits") << "for the claim";
  settings.Apply({{.ruri = AvatarBench::Drone("1").ruri, .blocked = true, .version = 1}});
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }").End(),
            "PERMISSION_DENIED");
  bench_.Commit();
  EXPECT_EQ(waits.End(), "PERMISSION_DENIED");
  EXPECT_EQ(bench_.counts().blocked, 1U);
  EXPECT_TRUE(bench_.counts().Balanced());
  settings.Apply({{.ruri = AvatarBench::Drone("1").ruri, .version = 2}});
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "STORED");
}

TEST_F(AvatarCallTest, ADroneThatCameBeforeTheStoreWasReadIsRefusedOnceItIs) {
  fleet::RobotSettings settings(1);
  bench_.fleet().entry().Set({.only_registered = true}, settings);
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 1 }").End(), "APPLIED");
  FakeCall& waits = bench_.Call(SampleType::kStatusText, kText);
  bench_.Commit();
  EXPECT_EQ(waits.End(), "waits") << "for the claim";
  bench_.fleet().odd_fleets().SetRead();
  settings.SetRead();
  static_cast<void>(bench_.fleet().Sweep(std::chrono::hours(1)));
  bench_.Commit();
  EXPECT_EQ(waits.End(), "PERMISSION_DENIED");
  EXPECT_THAT(std::string(waits.status().message()), HasSubstr("is not registered"));
  EXPECT_EQ(bench_.Call(SampleType::kHeading, "heading { heading_deg: 2 }").End(),
            "PERMISSION_DENIED");
  EXPECT_EQ(bench_.counts().blocked, 1U);
  EXPECT_TRUE(bench_.counts().Balanced());
  EXPECT_EQ(bench_.fleet().entry().candidates().All().size(), 1U);
  EXPECT_TRUE(bench_.store().Robots(10).value().empty());
  settings.Apply({{.ruri = AvatarBench::Drone("1").ruri, .registered = true, .version = 1}});
  EXPECT_EQ(Committed(SampleType::kStatusText, kText), "STORED");
}

TEST_F(AvatarCallTest, AGatewayWithoutNamesIsRefusedAlsoForADroneThatCalls) {
  const fleet::RobotSettings settings(1);
  bench_.fleet().entry().Set({.only_named = true}, settings);
  Begin();
  const identity::PeerIdentity hall{
      .role = identity::Role::kGateway, .fleet = "f", .gateway = {.subject = "CN=hall"}};
  FakeCall& call =
      bench_.CallBytes(hall, SampleType::kHeading,
                       test::RequestOf(SampleType::kHeading,
                                       "metadata { uav_id: \"1\" } heading { heading_deg: 1 }"));
  EXPECT_EQ(call.End(), "PERMISSION_DENIED");
  EXPECT_THAT(std::string(call.status().message()), HasSubstr("names no robots"));
}

TEST_F(AvatarCallTest, AnIdleDroneIsLetGoOf) {
  Begin();
  bench_.drones().Round();
  EXPECT_EQ(bench_.drones().size(), 1U);
  clock_.Advance(kDroneIdleMax + std::chrono::seconds(1));
  bench_.drones().Round();
  EXPECT_EQ(bench_.drones().size(), 0U);
}

}  // namespace
}  // namespace uplink::uncrew
