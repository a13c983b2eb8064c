#include "tools/uplink-fleet/robot/script.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "schema/judge.h"
#include "schema/rcan/judge.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kNowMs = 1'763'683'200'000;
/// Three minutes.
constexpr int kTicks = 1800;

schema::Judgement JudgeOf(schema::Judge& judge, const Outgoing& message) {
  return judge.Payload(std::as_bytes(std::span(message.payload)));
}

ScenarioOptions Options(double malformed_share) {
  ScenarioOptions options;
  options.run = "test";
  options.malformed_share = malformed_share;
  options.faults_hz = 1;
  return options;
}

class ScriptTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ScriptTest, EverythingMeantWellPassesJudgementWhole) {
  schema::Judge judge{schema::JudgeLimits()};
  RobotScript script(Options(0), GetParam());
  Account account;
  std::map<model::Variant, int> counts;
  for (int i = 0; i < kTicks; ++i) {
    for (const Outgoing& message : script.Tick(kNowMs + 100 * i, account)) {
      const schema::Judgement judgement = JudgeOf(judge, message);
      ASSERT_NE(judgement.record(), nullptr) << judgement.rejection()->field;
      EXPECT_TRUE(judgement.record()->dropped().empty());
      EXPECT_EQ(judgement.record()->durable(), message.keeping == Keeping::kDurable);
      ++counts[judgement.record()->variant()];
    }
  }
  EXPECT_EQ(counts.size(), model::kVariants) << "all sixteen";
  EXPECT_EQ(counts[model::Variant::kMotionTelemetry], kTicks);
  EXPECT_NEAR(counts[model::Variant::kStatusTelemetry], 0.1 * kTicks, 2);
  EXPECT_GT(counts[model::Variant::kMissionRunStatus], 20);
  EXPECT_TRUE(account.wrongs().empty());
  EXPECT_EQ(account.good(), account.sent().size());
}

TEST_P(ScriptTest, TheLastMessagesAreOneOfEachLiveKindAndKey) {
  schema::Judge judge{schema::JudgeLimits()};
  RobotScript script(Options(0), GetParam());
  Account account;
  for (int i = 0; i < kTicks; ++i) static_cast<void>(script.Tick(kNowMs + 100 * i, account));
  std::map<model::Variant, std::size_t> counts;
  for (const Outgoing& message : script.Last(kNowMs + 1'000'000, account)) {
    const schema::Judgement judgement = JudgeOf(judge, message);
    ASSERT_NE(judgement.record(), nullptr);
    EXPECT_FALSE(judgement.record()->durable());
    ++counts[judgement.record()->variant()];
  }
  EXPECT_EQ(counts.size(), 7U);
  const LastLive& live = account.live();
  EXPECT_EQ(counts[model::Variant::kSystemHealth], live.health.size());
  EXPECT_EQ(counts[model::Variant::kConsumableStatus], live.consumables.size());
  EXPECT_EQ(counts[model::Variant::kSpatialDirectiveStatus], live.directives.size());
  EXPECT_EQ(live.motion->unix_time_ms, kNowMs + 1'000'000);
  EXPECT_EQ(live.status->unix_time_ms, kNowMs + 1'000'000);
}

TEST_P(ScriptTest, AnswersWhatItIsAskedForWithWhatItLastReported) {
  schema::Judge judge{schema::JudgeLimits()};
  RobotScript script(Options(0), GetParam());
  Account account;
  for (int i = 0; i < kTicks; ++i) static_cast<void>(script.Tick(kNowMs + 100 * i, account));
  const auto settings = account.settings();
  const auto capabilities = account.ui_capabilities();
  const std::uint64_t sent = account.good();
  v1::ResendRequest request;
  EXPECT_TRUE(script.Answer(request, account).empty());
  request.add_kinds(v1::RESEND_KIND_AGENT_INFO);
  request.add_kinds(v1::RESEND_KIND_CURRENT_SETTINGS);
  request.add_kinds(v1::RESEND_KIND_UI_CAPABILITIES);
  std::set<model::Variant> variants;
  for (const Outgoing& message : script.Answer(request, account)) {
    const schema::Judgement judgement = JudgeOf(judge, message);
    ASSERT_NE(judgement.record(), nullptr);
    EXPECT_EQ(message.keeping, Keeping::kDurable);
    EXPECT_FALSE(message.latest_of.empty());
    variants.insert(judgement.record()->variant());
  }
  EXPECT_EQ(variants, (std::set{model::Variant::kAgentInfo, model::Variant::kCurrentSettings,
                                model::Variant::kUiCapabilities}));
  EXPECT_EQ(account.good(), sent + 3) << "each must be in the store";
  EXPECT_EQ(account.settings(), settings);
  EXPECT_EQ(account.ui_capabilities(), capabilities);
}

INSTANTIATE_TEST_SUITE_P(Robots, ScriptTest, ::testing::Values(0, 1, 2, 3, 4, 5, 6, 7));

TEST(Wrong, EachWayIsRejectedAsTheAccountSays) {
  schema::Judge judge{schema::JudgeLimits()};
  Wrong wrong(Seeded(1), "mark");
  Account account;
  std::set<model::RejectReason> reasons;
  for (std::size_t way = 0; way < kWaysToBeWrong; ++way) {
    const Outgoing message = wrong.Make(way, kNowMs, account);
    const WrongReport& report = account.wrongs().at(message.tag);
    reasons.insert(report.reason);
    EXPECT_EQ(message.keeping, Keeping::kDurable);
    if (message.content == Content::kNone) continue;  // the session's to reject
    const schema::Judgement judgement = JudgeOf(judge, message);
    ASSERT_NE(judgement.rejection(), nullptr) << way;
    EXPECT_EQ(judgement.rejection()->reason, report.reason) << way;
    EXPECT_EQ(judgement.rejection()->field, report.field) << way;
  }
  EXPECT_EQ(reasons.size(), 8U);
  EXPECT_EQ(account.good(), 0U);
}

/// What the states of one robot showed.
struct Arm {
  int states = 0;
  std::set<double> positions;
};

/// Expects that a state passes whole, as it was meant, and is the next one; notes where it stands.
void ExpectWholeState(const std::string& payload, const std::optional<model::RcanState>& meant,
                      Arm& arm) {
  const schema::RcanJudgement judgement =
      schema::JudgeRcanState(payload, "rcan://test/arm", 64 * 1024);
  ASSERT_EQ(judgement.rejection(), nullptr) << judgement.rejection()->field;
  EXPECT_TRUE(judgement.dropped.empty());
  const auto& state = std::get<model::RcanState>(judgement.verdict);
  EXPECT_EQ(state, *meant) << "numbers survive the text";
  EXPECT_EQ(state.seq, ++arm.states);
  ASSERT_EQ(state.joints.size(), kArmJoints);
  arm.positions.insert(*state.joints[0].position_rad);
  for (const model::RcanJoint& joint : state.joints) {
    EXPECT_FALSE(joint.effort_nm == 0 && std::signbit(*joint.effort_nm));
  }
}

TEST(RobotScript, ArmsSendRobotStatesThatPassWholeAndMove) {
  ScenarioOptions options = Options(0);
  options.rcan_share = 0.5;
  int arms = 0;
  for (std::size_t index = 0; index < 4; ++index) {
    RobotScript script(options, index);
    script.Name("rcan://test/arm");
    Account account;
    Arm arm;
    for (int i = 0; i < kTicks; ++i) {
      for (const Outgoing& message : script.Tick(kNowMs + 100 * i, account)) {
        if (message.content != Content::kRcanRobotState) continue;
        ASSERT_NO_FATAL_FAILURE(ExpectWholeState(message.payload, account.live().rcan, arm));
      }
    }
    if (arm.states > 0) ++arms;
    EXPECT_TRUE(arm.states == 0 || arm.positions.size() > 20);
  }
  EXPECT_EQ(arms, 2);
}

TEST(RobotScript, SendsAsMuchThatIsWrongAsAskedFor) {
  RobotScript script(Options(0.25), 0);
  Account account;
  for (int i = 0; i < kTicks; ++i) static_cast<void>(script.Tick(kNowMs + 100 * i, account));
  EXPECT_NEAR(static_cast<double>(account.wrongs().size()), 0.25 * kTicks, 80);
}

TEST(RobotScript, TheSameSeedGivesTheSameMessages) {
  Account first_account;
  Account second_account;
  Account other_account;
  RobotScript first(Options(0.1), 3);
  RobotScript second(Options(0.1), 3);
  RobotScript other(Options(0.1), 4);
  bool differs = false;
  for (int i = 0; i < kTicks; ++i) {
    const auto a = first.Tick(kNowMs + i, first_account);
    const auto b = second.Tick(kNowMs + i, second_account);
    const auto c = other.Tick(kNowMs + i, other_account);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].payload, b[k].payload);
    differs = differs || a.size() != c.size() || a[0].payload != c[0].payload;
  }
  EXPECT_TRUE(differs);
}

TEST(RobotScript, PaceMakesTheSlowThingsComeMoreOften) {
  std::map<double, std::size_t> durable;
  for (const double pace : {1.0, 5.0}) {
    ScenarioOptions options = Options(0);
    options.faults_hz = 0;
    options.pace = pace;
    RobotScript script(options, 0);
    Account account;
    for (int i = 0; i < kTicks; ++i) static_cast<void>(script.Tick(kNowMs + 100 * i, account));
    durable[pace] = account.good();
  }
  EXPECT_GT(durable[5], 3 * durable[1]);
}

TEST(RobotScript, IdsBearTheMarkOfTheRobotAndTheRun) {
  RobotScript script(Options(0), 6);
  Account account;
  for (int i = 0; i < kTicks; ++i) static_cast<void>(script.Tick(kNowMs + 100 * i, account));
  EXPECT_EQ(MarkOf("test", 6), "test-7");
  for (const auto& [key, run] : account.runs()) EXPECT_TRUE(key.second.starts_with("test-7-"));
  // Some are those of every robot of the run, on purpose.
  const auto own = [](const std::string& id) {
    return id.starts_with("test-7-") || id.starts_with("test-common");
  };
  for (const auto& [id, shape] : account.shapes()) EXPECT_TRUE(own(id)) << id;
  for (const auto& [id, object] : account.objects()) EXPECT_TRUE(own(id)) << id;
  for (const auto& [key, fault] : account.active()) EXPECT_EQ(key.second, SourceOf("test"));
}

}  // namespace
}  // namespace uplink::synthetic
