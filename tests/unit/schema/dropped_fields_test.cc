// How much is said of the invalid fields of one message.
#include <algorithm>
#include <limits>
#include <string>

#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::RejectReason;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kTold = schema::kDroppedFieldsListedMax;

/// So many invalid readings, and a good one behind them.
model::TelemetryExtras Readings(std::size_t invalid) {
  model::TelemetryExtras extras;
  for (std::size_t i = 0; i < invalid; ++i) {
    extras.kv.push_back({.key = "k" + std::to_string(i), .value = kNan, .unix_time_ms = {}});
  }
  extras.kv.push_back({.key = "good", .value = 7.0, .unix_time_ms = {}});
  return extras;
}

class DroppedFieldsTest : public testing::TestWithParam<std::size_t> {};

TEST_P(DroppedFieldsTest, AllAreCountedAndTheFirstAreTold) {
  const std::size_t invalid = GetParam();
  const schema::Judgement judgement = JudgeBody(Readings(invalid));
  ASSERT_NE(judgement.record(), nullptr);
  const auto dropped = judgement.record()->dropped();
  ASSERT_EQ(dropped.size(), std::min(invalid, kTold));
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    EXPECT_EQ(dropped[i].field, "kv[" + std::to_string(i) + "].value");
    EXPECT_EQ(dropped[i].reason, RejectReason::kNotFinite);
    ExpectReadable(dropped[i]);
  }
  const auto unlisted = judgement.record()->unlisted();
  ASSERT_EQ(unlisted.size(), invalid > kTold ? 1U : 0U);
  if (invalid > kTold) {
    EXPECT_EQ(unlisted[0], (model::UnlistedFields{RejectReason::kNotFinite, invalid - kTold}));
  }
  const auto kept = BodyOf<model::TelemetryExtras>(judgement).kv;
  ASSERT_EQ(kept.size(), 1U) << "what is good behind them is kept";
  EXPECT_EQ(kept[0].key, "good");
}

INSTANTIATE_TEST_SUITE_P(Bound, DroppedFieldsTest,
                         testing::Values(kTold - 1, kTold, kTold + 1, 255U));

TEST(UnlistedFieldsTest, AreCountedByTheirReasons) {
  model::TelemetryExtras extras = Readings(kTold + 2);
  extras.kv.push_back({.key = "", .value = 1.0, .unix_time_ms = {}});
  extras.kv.push_back({.key = "\xFF", .value = 1.0, .unix_time_ms = {}});
  extras.kv.push_back({.key = "", .value = 1.0, .unix_time_ms = {}});
  const schema::Judgement judgement = JudgeBody(extras);
  ASSERT_NE(judgement.record(), nullptr);
  const auto unlisted = judgement.record()->unlisted();
  ASSERT_EQ(unlisted.size(), 3U);
  EXPECT_EQ(unlisted[0], (model::UnlistedFields{RejectReason::kNotFinite, 2}));
  EXPECT_EQ(unlisted[1], (model::UnlistedFields{RejectReason::kMissingField, 2}));
  EXPECT_EQ(unlisted[2], (model::UnlistedFields{RejectReason::kTextNotUtf8, 1}));
}

TEST(UnlistedFieldsTest, AMessageOfNothingElseIsRejectedForTheFirst) {
  model::TelemetryExtras extras = Readings(200);
  extras.kv.pop_back();
  ExpectRejected(JudgeBody(extras), RejectReason::kNotFinite, "kv[0].value");
}

TEST(UnlistedFieldsTest, DoNotHideAnEmergencyStop) {
  model::StatusTelemetry status = SampleStatus();
  status.battery->soc_pct = 1000;
  status.battery->temperature = -300;
  status.estop = model::EStop{.unix_time_ms = 0, .active = true, .ids = {}};
  for (std::size_t i = 0; i + 1 < schema::kEStopIdsMax; ++i) status.estop->ids.emplace_back("\xFF");
  status.estop->ids.emplace_back("pulled");
  status.status = "\xFF";
  status.range_remaining = -1;
  const schema::Judgement judgement = JudgeBody(status);
  const auto kept = BodyOf<model::StatusTelemetry>(judgement);
  ASSERT_TRUE(kept.estop.has_value());
  EXPECT_TRUE(kept.estop->active);
  EXPECT_EQ(kept.estop->ids, (std::vector<std::string>{"pulled"}));
  EXPECT_FALSE(kept.status.has_value());
  EXPECT_FALSE(kept.range_remaining.has_value()) << "what is invalid is dropped, told or not";
  EXPECT_FALSE(kept.battery->soc_pct.has_value());
  EXPECT_EQ(judgement.record()->dropped().size(), kTold);
}

TEST(UnlistedFieldsTest, AViolationThatRejectsIsTold) {
  model::StatusTelemetry status = SampleStatus();
  status.estop = model::EStop{.unix_time_ms = 0, .active = true, .ids = {}};
  for (std::size_t i = 0; i <= schema::kEStopIdsMax; ++i) status.estop->ids.emplace_back("\xFF");
  ExpectRejected(JudgeBody(status), RejectReason::kTooManyItems, "estop.ids");
}

}  // namespace
}  // namespace uplink::test
