// What one publisher can do to the others.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  EXPECT_EQ(bench.ledger.Read()
                .messages.rejects[static_cast<std::size_t>(model::RejectReason::kMalformed)],
            100U);
  EXPECT_THAT(bench.store.Quarantine({})->rows, IsEmpty());
  EXPECT_THAT(bench.published, IsEmpty());
}

TEST(Flood, OfATwinThatWasNeverHeardTakesNothingFromOthersThatAreNoRobots) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.journal = {.robot_share = 100}});
  ASSERT_TRUE(bench.TakeLease());
  for (std::size_t i = 0; i < limits::PolicyOf(limits::PolicyId::kRejectsOfStranger).at_once + 100;
       ++i) {
    (void)bench.Publish(Bench::Of("telemetry"), "{");
  }
  using model::RejectReason;
  const auto rejects = [&bench](RejectReason reason) {
    return bench.ledger.Read().messages.rejects[static_cast<std::size_t>(reason)];
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
  EXPECT_EQ(rejects(RejectReason::kMalformed),
            limits::PolicyOf(limits::PolicyId::kRejectsOfStranger).at_once + 3);
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
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
  EXPECT_EQ(bench.ledger.Read().messages.in_flight, 12);
  bench.Run();
  EXPECT_EQ(bench.Count(Became::kStored), 12U);
  (void)bench.Publish(Bench::Of("telemetry"), Bench::Event(32));
  EXPECT_EQ(bench.ledger.Read().messages.in_flight, 1) << "there is room again";
  bench.Run();
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
}

TEST(Flood, WhatIsOverAnIdsBudgetIsRejectedUnreadAtQos0Alone) {
  testing::FakeDatabase database;
  Bench bench(database, 1);
  ASSERT_TRUE(bench.TakeLease());
  const std::string large = R"({"type":"event","detail":")" + std::string(60'000, 'x') + "\"}";
  const std::size_t passing = limits::PolicyOf(limits::PolicyId::kBytesOfId).at_once / large.size();
  // Commands to a twin that never reported.
  for (std::size_t i = 0; i < passing + 10; ++i) {
    (void)bench.Publish(Bench::Of("command"), large);
  }
  EXPECT_EQ(bench.Count(Became::kRejected), 10U);
  EXPECT_EQ(bench.Count(Became::kObserved), passing);
  EXPECT_THAT(bench.lines(), ::testing::ElementsAre(::testing::HasSubstr("twin_limited")));
  (void)bench.Publish(Bench::Of("command"), R"({"command":"small"})");
  EXPECT_EQ(bench.Count(Became::kObserved), passing + 1) << "small ones always pass";
  (void)bench.Publish(Bench::Of("telemetry"), large, {.id = 1, .handle = 1});
  bench.Run();
  EXPECT_EQ(bench.Count(Became::kStored), 1U);
  (void)bench.Publish(Bench::Of("command", kOtherTwin), large);
  EXPECT_EQ(bench.Count(Became::kObserved), passing + 2);
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
}

}  // namespace
}  // namespace uplink::broker
