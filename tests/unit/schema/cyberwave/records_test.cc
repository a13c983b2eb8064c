// What was judged as a record that stores keep.
#include "schema/cyberwave/records.h"

#include <string>
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

}  // namespace
}  // namespace uplink::cyberwave
