// How much of one id is looked into.
#include "server/broker/id_budgets.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using enum IdBudgets::Answer;

cyberwave::Topic TopicOf(std::uint32_t number) {
  cyberwave::Topic topic;
  topic.kind = cyberwave::TopicKind::kCommand;
  topic.identified = true;
  topic.id =
      *model::cyberwave::Uuid::FromText("00000000-0000-4000-8000-" + fmt::format("{:012}", number));
  return topic;
}

TEST(IdBudgets, AreEachIdsOwn) {
  IdBudgets budgets(kBytesOfId);
  const SteadyTime now{std::chrono::hours(1)};
  EXPECT_EQ(budgets.Take(TopicOf(1), kBytesOfId.burst, now), kPasses);
  EXPECT_EQ(budgets.Take(TopicOf(1), kBudgetedBytesMin, now), kOverAndTell);
  EXPECT_EQ(budgets.Take(TopicOf(1), kBudgetedBytesMin, now), kOver);
  EXPECT_EQ(budgets.Take(TopicOf(2), kBudgetedBytesMin, now), kPasses);
  const SteadyTime later = now + std::chrono::seconds(1);
  EXPECT_EQ(budgets.Take(TopicOf(1), kBytesOfId.rate, later), kPasses);
  EXPECT_EQ(budgets.Take(TopicOf(1), kBudgetedBytesMin, later), kOver) << "told already";
}

TEST(IdBudgets, AreOfAnIdUnderAPrefixAndOfAKind) {
  IdBudgets budgets({.rate = 1, .burst = 10});
  const SteadyTime now{std::chrono::hours(1)};
  EXPECT_EQ(budgets.Take(TopicOf(1), 10, now), kPasses);
  cyberwave::Topic same = TopicOf(1);
  same.kind = cyberwave::TopicKind::kPosition;
  EXPECT_EQ(budgets.Take(same, 1, now), kOverAndTell) << "another topic of the twin";
  cyberwave::Topic other = TopicOf(1);
  other.prefix = "lab/";
  EXPECT_EQ(budgets.Take(other, 10, now), kPasses);
  other = TopicOf(1);
  other.kind = cyberwave::TopicKind::kEnvironment;
  EXPECT_EQ(budgets.Take(other, 10, now), kPasses);
}

TEST(IdBudgets, OfAPingAreItsNames) {
  IdBudgets budgets(kBytesOfId);
  const SteadyTime now{std::chrono::hours(1)};
  cyberwave::Topic ping{.kind = cyberwave::TopicKind::kPing, .identified = true, .name = "a"};
  EXPECT_EQ(budgets.Take(ping, kBytesOfId.burst, now), kPasses);
  EXPECT_EQ(budgets.Take(ping, kBudgetedBytesMin, now), kOverAndTell);
  ping.name = "b";
  EXPECT_EQ(budgets.Take(ping, kBudgetedBytesMin, now), kPasses);
}

TEST(IdBudgets, AreSharedByThoseThatAreTooMany) {
  IdBudgets budgets(kBytesOfId);
  SteadyTime now{std::chrono::hours(1)};
  for (std::uint32_t id = 0; id < kBudgetsMax; ++id) {
    ASSERT_EQ(budgets.Take(TopicOf(id), kBytesOfId.rate, now), kPasses);
  }
  EXPECT_EQ(budgets.Take(TopicOf(kBudgetsMax), kBytesOfId.burst, now), kPasses);
  EXPECT_EQ(budgets.Take(TopicOf(kBudgetsMax + 1), kBudgetedBytesMin, now), kOverAndTell);
  // Those that sent no more make room.
  now += std::chrono::seconds(2);
  EXPECT_EQ(budgets.Take(TopicOf(kBudgetsMax + 2), kBytesOfId.burst, now), kPasses);
  EXPECT_EQ(budgets.Take(TopicOf(kBudgetsMax + 3), kBytesOfId.burst, now), kPasses);
}

TEST(IdBudgets, WhatIsOverThemIsRejectedUnreadAtQos0Alone) {
  testing::FakeDatabase database;
  Bench bench(database, 1);
  ASSERT_TRUE(bench.TakeLease());
  const std::string large = R"({"type":"event","detail":")" + std::string(60'000, 'x') + "\"}";
  const std::size_t passing = kBytesOfId.burst / large.size();
  // Of a twin that nobody heard, who is commanded.
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
