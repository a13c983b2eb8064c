#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::Body;

struct TimeCase {
  std::string name;
  std::function<Body(std::int64_t)> body;
  std::function<std::int64_t(const Body&)> time;
};

template <typename T, typename Member>
TimeCase Of(const std::string& name, T sample, Member member) {
  return {.name = name,
          .body =
              [sample, member](std::int64_t ms) {
                T body = sample;
                body.*member = ms;
                return Body(body);
              },
          .time =
              [member](const Body& body) {
                const std::optional<std::int64_t> time = std::get<T>(body).*member;
                return time.value_or(-1);
              }};
}

std::vector<TimeCase> TimeCases() {
  using model::MissionRunStatus;
  std::vector<TimeCase> cases = {
      Of("Motion", SampleMotion(), &model::MotionTelemetry::unix_time_ms),
      Of("Status", SampleStatus(), &model::StatusTelemetry::unix_time_ms),
      Of("Extras", SampleExtras(), &model::TelemetryExtras::unix_time_ms),
      Of("Health", SampleHealth(), &model::SystemHealth::unix_time_ms),
      Of("Usage", SampleUsage(), &model::UsageTelemetry::unix_time_ms),
      Of("LastReboot", SampleUsage(), &model::UsageTelemetry::last_reboot_unix_time_ms),
      Of("Consumable", SampleConsumable(), &model::ConsumableStatus::unix_time_ms),
      Of("LastEval", SampleDirective(), &model::SpatialDirectiveStatus::last_eval_time_ms),
      Of("Mission", SampleMission(), &MissionRunStatus::unix_time_ms),
      Of("Started", SampleMission(), &MissionRunStatus::time_started_ms),
      Of("ExpectedEnd", SampleMission(), &MissionRunStatus::expected_end_time_ms),
      Of("Completed", SampleMission(), &MissionRunStatus::time_completed_ms),
      Of("Fault", SampleFault(), &model::Fault::unix_time_ms),
      Of("Event", SampleEvent(), &model::EventTelemetry::unix_time_ms),
      Of("Message", SampleMessage(), &model::Message::unix_time_ms)};
  cases.push_back({"Reading",
                   [](std::int64_t ms) {
                     model::TelemetryExtras body = SampleExtras();
                     body.kv[0].unix_time_ms = ms;
                     return Body(body);
                   },
                   [](const Body& body) {
                     return *std::get<model::TelemetryExtras>(body).kv[0].unix_time_ms;
                   }});
  cases.push_back(
      {"ShapeExpiry",
       [](std::int64_t ms) {
         model::ReportedShape shape = SampleShape();
         shape.expire_time_ms = ms;
         return Body(model::ShapeOp{shape});
       },
       [](const Body& body) { return std::get<model::ShapeOp>(body).upsert()->expire_time_ms; }});
  cases.push_back({"ObjectExpiry",
                   [](std::int64_t ms) {
                     model::Object object = SampleObject();
                     object.expires_unix_time_ms = ms;
                     return Body(model::ObjectOp{object});
                   },
                   [](const Body& body) {
                     return std::get<model::ObjectOp>(body).upsert()->expires_unix_time_ms;
                   }});
  return cases;
}

class TimeRuleTest : public testing::TestWithParam<TimeCase> {};

TEST_P(TimeRuleTest, IsUnknownAndCountedOutsideOurCentury) {
  constexpr std::int64_t kYear2100 = 4'102'444'800'000;
  for (const std::int64_t good : {std::int64_t{0}, std::int64_t{1}, kYear2100 - 1}) {
    const schema::Judgement judgement = JudgeBody(GetParam().body(good));
    ExpectGood(judgement);
    EXPECT_EQ(GetParam().time(judgement.record()->body()), good);
    EXPECT_EQ(judgement.times_unknown, 0U);
  }
  for (const std::int64_t odd : {std::int64_t{-1}, std::numeric_limits<std::int64_t>::min(),
                                 kYear2100, std::numeric_limits<std::int64_t>::max()}) {
    const schema::Judgement judgement = JudgeBody(GetParam().body(odd));
    ExpectGood(judgement);
    EXPECT_EQ(GetParam().time(judgement.record()->body()), 0) << odd;
    EXPECT_EQ(judgement.times_unknown, 1U) << odd;
  }
}

INSTANTIATE_TEST_SUITE_P(Times, TimeRuleTest, testing::ValuesIn(TimeCases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace uplink::test
