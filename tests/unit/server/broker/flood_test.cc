// What one publisher can do to the others.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/heard.h"
#include "server/broker/limits.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::IsEmpty;

TEST(Flood, OfBadPingsLeavesNoRows) {
  testing::FakeDatabase database;
  Bench bench(database, 1);
  ASSERT_TRUE(bench.TakeLease());
  for (int i = 0; i < 100; ++i) (void)bench.Publish("cyberwave/ping/a/request", "{bad");
  bench.Run();
  EXPECT_EQ(bench.Count(Became::kRejected), 100U);
  EXPECT_EQ(bench.ledger.Read().rejects[static_cast<std::size_t>(model::RejectReason::kMalformed)],
            100U);
  EXPECT_THAT(bench.store.Quarantine({})->rows, IsEmpty());
  EXPECT_THAT(bench.published, IsEmpty());
}

TEST(Flood, OfATwinThatWasNeverHeardTakesNothingFromOthersThatAreNoRobots) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.journal = {.robot_share = 100}});
  ASSERT_TRUE(bench.TakeLease());
  for (std::size_t i = 0; i < kRejectsOfStranger.burst + 100; ++i) {
    (void)bench.Publish(Bench::Of("telemetry"), "{");
  }
  using model::RejectReason;
  const auto rejects = [&bench](RejectReason reason) {
    return bench.ledger.Read().rejects[static_cast<std::size_t>(reason)];
  };
  EXPECT_EQ(rejects(RejectReason::kRateLimited), 100U);
  EXPECT_THAT(bench.lines(), ::testing::ElementsAre(
                                 ::testing::HasSubstr(std::string("twin_limited id=") + kTwin)));
  (void)bench.Publish(Bench::Of("telemetry", kOtherTwin), "{");
  (void)bench.Publish(std::string("cyberwave/environment/") + kOtherTwin + "/telemetry", "{");
  EXPECT_EQ(rejects(RejectReason::kRateLimited), 100U);
  bench.clock.Advance(std::chrono::seconds(1));
  (void)bench.Publish(Bench::Of("telemetry"), "{");
  EXPECT_EQ(rejects(RejectReason::kRateLimited), 100U);
  bench.Run();
  EXPECT_EQ(rejects(RejectReason::kMalformed), kRejectsOfStranger.burst + 3);
  EXPECT_TRUE(bench.ledger.Read().Balanced());
}

TEST(Flood, AtQos0TakesNoMoreOfTheJournalThanOnesShare) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.journal = {.records_max = 100, .robot_share = 10}});
  ASSERT_TRUE(bench.TakeLease());
  for (int i = 0; i < 30; ++i) (void)bench.Publish(Bench::Of("telemetry"), Bench::Event(i));
  EXPECT_EQ(bench.Count(Became::kRefused), 20U);
  EXPECT_THAT(bench.lines(), ::testing::ElementsAre(
                                 ::testing::HasSubstr("twin_limited robot=" + RuriOf(kTwin) +
                                                      " why=\"its share of the journal is full")));
  (void)bench.Publish(Bench::Of("telemetry", kOtherTwin), Bench::Event(1));
  EXPECT_EQ(bench.Count(Became::kRefused), 20U) << "another's has room";
  // Its publisher is held back by our acks.
  EXPECT_EQ(bench.Publish(Bench::Of("telemetry"), Bench::Event(31), {.id = 1, .handle = 1}),
            Intake::Processed::kDone);
  EXPECT_EQ(bench.ledger.Read().in_flight, 12);
  bench.Run();
  EXPECT_EQ(bench.Count(Became::kStored), 12U);
  (void)bench.Publish(Bench::Of("telemetry"), Bench::Event(32));
  EXPECT_EQ(bench.ledger.Read().in_flight, 1) << "there is room again";
  bench.Run();
  EXPECT_TRUE(bench.ledger.Read().Balanced());
}

TEST(Flood, ThatTheBrokerIsTooSlowForIsFoundOutByItsPings) {
  testing::ManualClock clock;
  BrokerProbe probe;
  const mqtt::ClientProbe durable;
  Heard heard(clock, probe);
  Heard::Standing standing{.subscribed = true, .unacked_max = 10};
  for (int second = 0; second < kLiveBehindMax.count() + kLivePingWaitMax.count(); ++second) {
    EXPECT_FALSE(heard.live_is_old()) << second;
    standing.live_ping_waited = std::chrono::seconds(second);
    heard.Look(standing, durable);
    clock.Advance(std::chrono::seconds(1));
  }
  EXPECT_TRUE(heard.live_is_old());
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kBehind);
  standing.live_ping_waited = milliseconds(1'999);
  heard.Look(standing, durable);
  EXPECT_FALSE(heard.live_is_old());
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kUpToDate);
}

TEST(Flood, ThatWeAreTooSlowForTakesNobodyOffline) {
  testing::ManualClock clock;
  BrokerProbe probe;
  const mqtt::ClientProbe durable;
  Heard heard(clock, probe);
  Heard::Standing standing{.subscribed = true, .unacked_max = 10};
  const auto pass = [&](int seconds) {
    for (int i = 0; i < seconds; ++i) {
      clock.Advance(std::chrono::seconds(1));
      heard.Look(standing, durable);
    }
  };
  standing.live_unread = kLiveBehindBytes - 1;
  pass(20);
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kUpToDate);
  standing.live_unread = kLiveBehindBytes;
  pass(2);
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kUpToDate) << "it may be one burst";
  pass(1);
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kBehind);
  EXPECT_EQ(probe.behind.value(), 0);
  EXPECT_FALSE(heard.live_is_old());
  pass(8);
  EXPECT_EQ(probe.behind.value(), 1) << "and it is shown";
  EXPECT_TRUE(heard.live_is_old());
  standing.live_unread = 0;
  pass(1);
  EXPECT_FALSE(heard.live_is_old());
  EXPECT_EQ(heard.hearing(), fleet::Fleet::Hearing::kUpToDate);
  standing.subscribed = false;
  pass(1);
  standing.subscribed = true;
  pass(static_cast<int>(kLiveBehindShown.count()) - 3);
  EXPECT_EQ(probe.behind.value(), 1) << "though it is made anew";
  pass(1);
  EXPECT_EQ(probe.behind.value(), 0);
}

}  // namespace
}  // namespace uplink::broker
