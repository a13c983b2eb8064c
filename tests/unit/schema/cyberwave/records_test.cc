// What was judged as a record that stores keep.
#include "schema/cyberwave/records.h"

#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::MessageLevel;
using model::cyberwave::DriverLog;
using test::BodyOf;
using test::JudgeOn;

TEST(CyberwaveRecords, ALogLineIsAMessageForPeople) {
  const std::string payload = R"({"message":"warm","level":"WARN","timestamp":1795362733.5,)"
                              R"("source":"arm"})";
  const Judgement judgement = JudgeOn("driverlog", payload);
  const model::Record record =
      Records::Of(BodyOf<DriverLog>(judgement), judgement.head, payload.size());
  EXPECT_EQ(record.variant(), model::Variant::kMessage);
  EXPECT_TRUE(record.durable());
  EXPECT_EQ(record.payload_bytes(), payload.size());
  const auto& message = std::get<model::Message>(record.body());
  EXPECT_EQ(message.message, "warm");
  EXPECT_EQ(message.level, MessageLevel::kWarn);
  EXPECT_EQ(message.unix_time_ms, 1'795'362'733'500);
  EXPECT_EQ(message.detail_json, BodyOf<DriverLog>(judgement).detail);
  EXPECT_NE(message.detail_json.find(R"("level":"WARN")"), std::string::npos);
}

TEST(CyberwaveRecords, EachLevelHasItsPlace) {
  for (const auto& [word, level] :
       {std::pair{"debug", MessageLevel::kInfo}, std::pair{"INFO", MessageLevel::kInfo},
        std::pair{"whatever", MessageLevel::kInfo}, std::pair{"warning", MessageLevel::kWarn},
        std::pair{"Error", MessageLevel::kError}, std::pair{"critical", MessageLevel::kError}}) {
    const Judgement judgement =
        JudgeOn("driverlog", R"({"message":"m","level":")" + std::string(word) + "\"}");
    const model::Record record = Records::Of(BodyOf<DriverLog>(judgement), judgement.head, 1);
    const auto& message = std::get<model::Message>(record.body());
    EXPECT_EQ(message.level, level) << word;
    EXPECT_EQ(message.unix_time_ms, 0) << "no time was said";
  }
}

TEST(CyberwaveRecords, AnUpdateOfAScopeIsThatOfItsTopic) {
  for (const auto& [topic, payload, scope, type] :
       {std::tuple{"environment/weather", R"({"type":"weather","data":{},"timestamp":2})",
                   model::ScopeKind::kEnvironment, "weather"},
        std::tuple{"workflow-run", R"({"status":"running","timestamp":2})",
                   model::ScopeKind::kWorkflowRun, "running"}}) {
    const Judgement judgement = JudgeOn(topic, payload);
    const model::ScopeUpdate update = Records::Of(BodyOf<model::cyberwave::ScopeUpdate>(judgement),
                                                  judgement.topic.id, judgement.head);
    EXPECT_EQ(update.scope, scope);
    EXPECT_EQ(update.id, test::kEnvironment);
    EXPECT_EQ(update.type, type);
    EXPECT_EQ(update.unix_time_ms, 2'000);
    EXPECT_NE(update.detail_json.find(type), std::string::npos);
  }
}

TEST(CyberwaveRecords, ScopesHaveTextsThatLeadBack) {
  for (const model::ScopeKind kind :
       {model::ScopeKind::kEnvironment, model::ScopeKind::kWorkflowRun}) {
    EXPECT_EQ(model::ScopeKindFromText(ToText(kind)), kind);
  }
  EXPECT_FALSE(model::ScopeKindFromText("workflow-run"));
  EXPECT_FALSE(model::ScopeKindFromText(""));
}

}  // namespace
}  // namespace uplink::cyberwave
