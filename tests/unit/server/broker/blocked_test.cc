// Twins that operators blocked, or did not add: their messages are acked, counted and dropped.
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/fleet/robot_settings.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Processed = Intake::Processed;

constexpr const char* kPosition = R"({"source_type":"edge","position":{"x":1,"y":2,"z":3}})";

class BlockedTest : public ::testing::Test {
 protected:
  BlockedTest() {
    EXPECT_TRUE(bench_.TakeLease());
    Rule({});
    settings_.OnChange([this](std::span<const fleet::RobotSettings::Change> changes) {
      bench_.fleet.OnSettings(changes);
    });
  }
  ~BlockedTest() override { EXPECT_TRUE(bench_.ledger.Read().messages.Balanced()); }

  void Rule(const fleet::EntryRules& rules) { bench_.fleet.entry().Set(rules, settings_); }
  void StoreIsRead() {
    bench_.fleet.odd_fleets().SetRead();
    settings_.SetRead();
  }
  void Apply(storage::RobotSetting setting) {
    setting.ruri = RuriOf(kTwin);
    setting.version = ++version_;
    settings_.Apply({setting});
  }
  void Publish(const std::string& tail, const std::string& payload, std::uint64_t handle) {
    EXPECT_EQ(bench_.Publish(Bench::Of(tail), payload,
                             {.id = static_cast<std::uint16_t>(handle), .handle = handle}),
              Processed::kDone);
  }
  std::vector<storage::EventRow> Events() { return bench_.store.Events({})->rows; }

  testing::FakeDatabase database_;
  fleet::RobotSettings settings_{10};
  Bench bench_{database_, 1};

 private:
  storage::AccessVersion version_ = 0;
};

TEST_F(BlockedTest, MessagesOfABlockedTwinAreAckedAndKeptNowhere) {
  Apply({.blocked = true});
  Publish("telemetry", Bench::Event(1), 11);
  Publish("position", kPosition, 12);
  Publish("position", "no json", 13);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U, 13U));
  EXPECT_EQ(bench_.Count(Became::kBlocked), 3U);
  EXPECT_EQ(bench_.Count(Became::kRejected), 0U);
  EXPECT_EQ(bench_.fleet.Find(RuriOf(kTwin)), nullptr);
  EXPECT_THAT(Events(), IsEmpty());
  EXPECT_THAT(bench_.store.Quarantine({})->rows, IsEmpty());
}

TEST_F(BlockedTest, ABlockEndsTheStreamOnceWhatItTookIsStored) {
  Publish("telemetry", Bench::Event(1), 11);
  Apply({.blocked = true});
  bench_.Look();
  Publish("telemetry", Bench::Event(2), 12);
  EXPECT_EQ(bench_.streams.size(), 1U) << "the first message waits for its commit";
  bench_.Run();
  EXPECT_EQ(bench_.streams.size(), 0U);
  EXPECT_THAT(bench_.Acked(), ::testing::UnorderedElementsAre(11U, 12U));
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  EXPECT_EQ(bench_.Count(Became::kBlocked), 1U);
  EXPECT_THAT(Events(), SizeIs(1));
}

TEST_F(BlockedTest, ABlockEndsTheConnectionThatWasOpenAndNoneBegins) {
  constexpr const char* kOfSession =
      R"({"source_type":"edge","session_id":"s1","position":{"x":1,"y":2,"z":3}})";
  Publish("position", kOfSession, 11);
  bench_.Run();
  EXPECT_THAT(bench_.kept.begun(), SizeIs(1));
  Apply({.blocked = true});
  bench_.Look();
  Publish("position", kOfSession, 12);
  const std::vector<storage::ConnectionItem> ended = bench_.kept.ended();
  ASSERT_THAT(ended, SizeIs(1));
  EXPECT_EQ(ended[0].ended->why, model::ConnectionEnd::kRefused);
  EXPECT_EQ(ended[0].ended->detail, "blocked");
  EXPECT_THAT(bench_.kept.begun(), SizeIs(1));
}

TEST_F(BlockedTest, AnotherTwinNoticesNothing) {
  Apply({.blocked = true});
  EXPECT_EQ(bench_.Publish(Bench::Of("position", kOtherTwin), kPosition), Processed::kDone);
  EXPECT_EQ(bench_.Count(Became::kApplied), 1U);
}

TEST_F(BlockedTest, AnUnblockedTwinIsHeardAgain) {
  Publish("telemetry", Bench::Event(1), 11);
  Apply({.blocked = true});
  Apply({});
  Publish("telemetry", Bench::Event(2), 12);
  bench_.Run();
  Publish("telemetry", Bench::Event(3), 13);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U, 12U, 13U));
  EXPECT_EQ(bench_.Count(Became::kStored), 3U);
}

TEST_F(BlockedTest, TakingTopicsOverOpensNoStreamOfABlockedTwin) {
  ASSERT_TRUE(bench_.fleet.AdmitNew({.ruri = RuriOf(kTwin), .fleet = "arms"}).ok());
  Apply({.blocked = true});
  bench_.streams.OpenKnown({""}, TwinStreams::Which::kAll);
  EXPECT_EQ(bench_.streams.size(), 0U);
}

TEST_F(BlockedTest, WhereRegistrationIsClosedANewTwinMustBeAdded) {
  Rule({.only_registered = true});
  StoreIsRead();
  Publish("telemetry", Bench::Event(1), 11);
  EXPECT_THAT(bench_.Acked(), ElementsAre(11U));
  EXPECT_EQ(bench_.Count(Became::kBlocked), 1U);
  EXPECT_THAT(bench_.fleet.entry().candidates().All(), SizeIs(1));
  EXPECT_EQ(bench_.twins.Find(RuriOf(kTwin)), nullptr);
  Apply({.registered = true});
  Publish("telemetry", Bench::Event(2), 12);
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
}

TEST_F(BlockedTest, ATwinThatCameBeforeTheStoreWasReadIsDroppedOnceItIs) {
  Rule({.only_registered = true});
  Publish("telemetry", Bench::Event(1), 11);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), IsEmpty()) << "no one can tell yet";
  StoreIsRead();
  static_cast<void>(bench_.fleet.Sweep(std::chrono::hours(1)));
  bench_.Run();
  EXPECT_EQ(bench_.streams.size(), 0U);
  EXPECT_TRUE(bench_.commits.TakeFenced()) << "the broker delivers it again";
  EXPECT_THAT(bench_.fleet.entry().candidates().All(), SizeIs(1));
  Publish("telemetry", Bench::Event(1), 12);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(12U));
  EXPECT_EQ(bench_.Count(Became::kBlocked), 1U);
  EXPECT_THAT(Events(), IsEmpty());
  EXPECT_THAT(bench_.store.Robots(10).value(), IsEmpty());
}

TEST_F(BlockedTest, DeliveriesAgainAndRetainedMessagesOfABlockedTwinAreAckedAndKeptNowhere) {
  Apply({.blocked = true});
  const std::string topic = Bench::Of("telemetry");
  EXPECT_EQ(bench_.Publish(topic, Bench::Event(1), {.id = 1, .handle = 11}), Processed::kDone);
  EXPECT_EQ(bench_.Publish(topic, Bench::Event(1), {.id = 1, .dup = true, .handle = 12}),
            Processed::kDone);
  EXPECT_EQ(bench_.Publish(topic, Bench::Event(2), {.id = 2, .retained = true, .handle = 13}),
            Processed::kDone);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ::testing::UnorderedElementsAre(11U, 12U, 13U));
  EXPECT_EQ(bench_.Count(Became::kBlocked), 1U);
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 1U);
  EXPECT_EQ(bench_.Count(Became::kIgnored), 1U);
  EXPECT_THAT(Events(), IsEmpty());
}

TEST_F(BlockedTest, ADeliveryAgainOfWhatWasTakenBeforeTheBlockIsStoredOnce) {
  const std::string topic = Bench::Of("telemetry");
  EXPECT_EQ(bench_.Publish(topic, Bench::Event(1), {.id = 1, .handle = 11}), Processed::kDone);
  Apply({.blocked = true});
  EXPECT_EQ(bench_.Publish(topic, Bench::Event(1), {.id = 1, .dup = true, .handle = 12}),
            Processed::kDone);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(12U)) << "by its last delivery";
  EXPECT_EQ(bench_.Count(Became::kStored), 1U);
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 1U);
  EXPECT_EQ(bench_.Count(Became::kBlocked), 0U);
  EXPECT_THAT(Events(), SizeIs(1));
  EXPECT_EQ(bench_.streams.size(), 0U);
}

}  // namespace
}  // namespace uplink::broker
