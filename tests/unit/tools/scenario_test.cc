#include "tools/uplink-fleet/scenario.h"

#include <cstddef>
#include <set>
#include <span>

#include <gtest/gtest.h>

#include "schema/judge.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kNowMs = 1'763'683'200'000;
constexpr int kTicks = 2000;

schema::Judgement JudgeOf(schema::Judge& judge, const Outgoing& message) {
  return judge.Payload(std::as_bytes(std::span(message.payload)));
}

ScenarioOptions Options(double malformed_share) {
  ScenarioOptions options;
  options.run = "test";
  options.malformed_share = malformed_share;
  options.faults_hz = 5;
  return options;
}

TEST(RobotScript, EverythingMeantWellPassesJudgement) {
  schema::Judge judge{schema::JudgeLimits()};
  RobotScript script(Options(0), 0);
  Ledger ledger;
  for (int i = 0; i < kTicks; ++i) {
    for (const Outgoing& message : script.Tick(kNowMs + i, ledger)) {
      const schema::Judgement judgement = JudgeOf(judge, message);
      ASSERT_NE(judgement.record(), nullptr);
      EXPECT_TRUE(judgement.record()->dropped().empty());
      EXPECT_EQ(judgement.record()->durable(), message.keeping == Keeping::kDurable);
    }
  }
  EXPECT_GT(ledger.faults.size(), 500U);
  EXPECT_TRUE(ledger.wrongs.empty());
}

TEST(RobotScript, EverythingMeantWrongIsRejectedAsTheLedgerSays) {
  schema::Judge judge{schema::JudgeLimits()};
  RobotScript script(Options(1), 0);
  Ledger ledger;
  std::set<model::RejectReason> reasons;
  for (int i = 0; i < kTicks; ++i) {
    for (const Outgoing& message : script.Tick(kNowMs + i, ledger)) {
      const auto wrong = ledger.wrongs.find(message.tag);
      if (wrong == ledger.wrongs.end()) continue;
      reasons.insert(wrong->second.reason);
      if (message.content == Content::kNone) continue;  // the session's to reject
      const schema::Judgement judgement = JudgeOf(judge, message);
      ASSERT_NE(judgement.rejection(), nullptr);
      EXPECT_EQ(judgement.rejection()->reason, wrong->second.reason);
      EXPECT_EQ(judgement.rejection()->field, wrong->second.field);
    }
  }
  EXPECT_EQ(reasons.size(), 5U);
}

TEST(RobotScript, TheSameSeedGivesTheSameMessages) {
  Ledger first_ledger;
  Ledger second_ledger;
  RobotScript first(Options(0.1), 3);
  RobotScript second(Options(0.1), 3);
  RobotScript other(Options(0.1), 4);
  bool differs = false;
  Ledger other_ledger;
  for (int i = 0; i < 100; ++i) {
    const auto a = first.Tick(kNowMs, first_ledger);
    const auto b = second.Tick(kNowMs, second_ledger);
    const auto c = other.Tick(kNowMs, other_ledger);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].payload, b[k].payload);
    differs = differs || a.size() != c.size() || a[0].payload != c[0].payload;
  }
  EXPECT_TRUE(differs);
}

TEST(RobotScript, TheLedgersActiveSetFollowsTheReports) {
  RobotScript script(Options(0), 0);
  Ledger ledger;
  for (int i = 0; i < kTicks; ++i) {
    static_cast<void>(script.Tick(kNowMs + i, ledger));
    for (const auto& [key, description] : ledger.active) {
      ASSERT_EQ(ledger.faults.count(description), 1U);
      EXPECT_TRUE(ledger.faults[description].fault.active);
    }
  }
  EXPECT_LE(ledger.active.size(), 8U);
}

}  // namespace
}  // namespace uplink::synthetic
