// What a good sample of each type becomes: a value, its key, its JSON.
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <boost/json.hpp>
#include <gtest/gtest.h>

#include "schema/json/uncrew.h"
#include "schema/model/held_bytes.h"
#include "schema/uncrew/judge.h"
#include "tests/unit/schema/uncrew/requests.h"
#include "tests/unit/schema/uncrew/samples.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using test::RequestOf;
using test::Sample;
using test::Type;

constexpr std::string_view kMetadata =
    R"(metadata { uav_id: "d1" sampled_at_unix_us: 1700000000000000 sampled_at_boot_us: 9 })";

Judgement JudgeText(Type type, std::string_view text) { return Judge(type, RequestOf(type, text)); }

/// With each number as a double: 1 and 1.0 are the same.
// NOLINTNEXTLINE(misc-no-recursion): as deep as a sample
boost::json::value WithDoubles(boost::json::value value) {
  if (value.is_number()) return value.to_number<double>();
  if (auto* object = value.if_object()) {
    for (auto& member : *object) member.value() = WithDoubles(member.value());
  } else if (auto* items = value.if_array()) {
    for (auto& item : *items) item = WithDoubles(item);
  }
  return value;
}

class EveryType : public ::testing::TestWithParam<Sample> {};

TEST_P(EveryType, IsJudgedWithItsTimesAndDropsNothing) {
  const Sample& sample = GetParam();
  const Judgement judged = JudgeText(sample.type, std::string(kMetadata).append(sample.text));
  ASSERT_EQ(judged.rejection(), nullptr) << judged.rejection()->detail;
  EXPECT_TRUE(judged.decoded);
  EXPECT_TRUE(judged.dropped.empty());
  EXPECT_EQ(judged.enumerants_unrecognized, 0U);
  EXPECT_EQ(judged.metadata.uav_id, "d1");
  EXPECT_EQ(judged.metadata.sampled_at_us, 1'700'000'000'000'000);
  EXPECT_EQ(judged.metadata.boot_us, 9U);
  EXPECT_TRUE(judged.metadata.timed());
  EXPECT_EQ(TypeOf(*judged.value()), sample.type);
  EXPECT_EQ(KeyOf(*judged.value()).has_value(), uc::RowOf(sample.type).parts_max > 1);
}

TEST_P(EveryType, IsShownByTheContractsNames) {
  const Sample& sample = GetParam();
  const Judgement judged = JudgeText(sample.type, sample.text);
  ASSERT_NE(judged.value(), nullptr);
  boost::json::object expected =
      boost::json::parse({sample.json.data(), sample.json.size()}).get_object();
  const auto stamp = [](boost::json::object& object) {
    object["sampledAt"] = "1970-01-01T00:00:00.000003Z";
    object["receivedAt"] = "1970-01-01T00:00:00.004Z";
  };
  if (sample.type == Type::kAlerts || sample.type == Type::kOperatorRequests) {
    for (auto& item : expected) stamp(item.value().get_object());
  } else {
    stamp(expected);
  }
  const boost::json::object shown =
      json::Render(*judged.value(), {.sampled_at_us = 3, .received_at = FromUnixMs(4)});
  EXPECT_EQ(WithDoubles(shown), WithDoubles(expected)) << shown;
}

TEST_P(EveryType, HasUnknownFieldsThatAreIgnored) {
  const Sample& sample = GetParam();
  std::string request = RequestOf(sample.type, sample.text);
  const Judgement before = Judge(sample.type, request);
  request += std::string("\xf8\x3f\x07", 3);  // field 1023, a varint
  const Judgement after = Judge(sample.type, request);
  ASSERT_NE(after.value(), nullptr);
  EXPECT_TRUE(*after.value() == *before.value());
}

TEST_P(EveryType, IsMalformedIfItIsCut) {
  const Sample& sample = GetParam();
  std::string request = RequestOf(sample.type, sample.text);
  request.pop_back();
  const Judgement judged = Judge(sample.type, request);
  ASSERT_NE(judged.rejection(), nullptr);
  EXPECT_EQ(judged.rejection()->reason, model::RejectReason::kMalformed);
  EXPECT_FALSE(judged.decoded);
}

TEST_P(EveryType, NeedsItsSample) {
  const Type type = GetParam().type;
  const Judgement judged = JudgeText(type, kMetadata);
  ASSERT_NE(judged.rejection(), nullptr);
  EXPECT_EQ(judged.rejection()->reason, model::RejectReason::kMissingField);
  EXPECT_EQ(judged.rejection()->field, uc::RowOf(type).member);
  EXPECT_TRUE(judged.decoded);
  EXPECT_EQ(judged.metadata.uav_id, "d1");
}

INSTANTIATE_TEST_SUITE_P(Contract, EveryType, ::testing::ValuesIn(test::kSamples),
                         [](const auto& each) {
                           return std::string(uc::RowOf(each.param.type).name);
                         });

TEST(Types, AreFoundByTheirMethod) {
  EXPECT_EQ(uc::TypeOfMethod("PublishGPSInfo"), Type::kGpsInfo);
  EXPECT_EQ(uc::TypeOfMethod("PublishAlert"), Type::kAlerts);
  EXPECT_EQ(uc::TypeOfMethod("SubscribeUAVCommands"), std::nullopt);
}

TEST(Types, KeepTheNumbersThatStoresHold) {
  EXPECT_EQ(static_cast<int>(Type::kRejected), 0);
  EXPECT_EQ(static_cast<int>(Type::kAltitude), 1);
  EXPECT_EQ(static_cast<int>(Type::kArmed), 2);
  EXPECT_EQ(static_cast<int>(Type::kConnectionEvent), 5);
  EXPECT_EQ(static_cast<int>(Type::kCurrentMissionItem), 6);
  EXPECT_EQ(static_cast<int>(Type::kError), 8);
  EXPECT_EQ(static_cast<int>(Type::kFlightMode), 9);
  EXPECT_EQ(static_cast<int>(Type::kStatusText), 18);
  EXPECT_EQ(static_cast<int>(Type::kUncrewFlightMode), 19);
  EXPECT_EQ(static_cast<int>(Type::kAlerts), 24);
  EXPECT_EQ(static_cast<int>(Type::kOperatorRequests), 25);
  EXPECT_EQ(static_cast<int>(Type::kCommandResult), 26);
}

TEST(Values, AreUnknownWhereTheyAreAbsentOrNan) {
  for (const std::string_view text :
       {"battery { id: 4 }", "battery { id: 4 voltage_v: nan remaining_percent: nan }"}) {
    const Judgement judged = JudgeText(Type::kBattery, text);
    ASSERT_NE(judged.value(), nullptr) << text;
    EXPECT_TRUE(judged.dropped.empty());
    EXPECT_TRUE(std::get<uc::Battery>(*judged.value()) == uc::Battery{.key = 4});
  }
  const Judgement zero = JudgeText(Type::kBattery, "battery { voltage_v: 0 }");
  EXPECT_EQ(std::get<uc::Battery>(*zero.value()).voltage_v, 0.0F);
}

TEST(Values, KeepEnumerantsThatAreUnknownAsNumbers) {
  for (const auto& [number, shown] :
       {std::pair{"77", "unrecognized_77"}, std::pair{"-1", "unrecognized_-1"},
        std::pair{"100000", "unrecognized_100000"}}) {
    const Judgement judged =
        JudgeText(Type::kFlightMode, std::string("flight_mode { mode: ") + number + " }");
    ASSERT_NE(judged.value(), nullptr);
    EXPECT_EQ(judged.enumerants_unrecognized, 1U);
    EXPECT_EQ(model::EnumText(std::get<uc::FlightMode>(*judged.value()).mode), shown);
  }
}

TEST(Values, HaveNeitherOrBothOfLatitudeAndLongitude) {
  for (const std::string_view text :
       {"latitude_deg: 1", "longitude_deg: 1", "latitude_deg: 1 longitude_deg: nan",
        "latitude_deg: 91 longitude_deg: 1", "latitude_deg: 1 longitude_deg: 181"}) {
    const Judgement judged =
        JudgeText(Type::kPosition, "position { relative_altitude_m: 5 " + std::string(text) + " }");
    ASSERT_NE(judged.value(), nullptr) << text;
    EXPECT_TRUE(std::get<uc::Position>(*judged.value()) ==
                uc::Position{.relative_altitude_m = 5.0F})
        << text;
  }
}

TEST(Values, ClampPercentAndTurnAngles) {
  const auto percent = [](const char* text) {
    const Judgement judged =
        JudgeText(Type::kBattery, std::string("battery { remaining_percent: ") + text + " }");
    return std::get<uc::Battery>(*judged.value()).remaining_percent;
  };
  EXPECT_EQ(percent("-5"), 0.0F);
  EXPECT_EQ(percent("105"), 100.0F);
  EXPECT_EQ(percent("99.5"), 99.5F);
  const auto yaw = [](const char* text) {
    const Judgement judged =
        JudgeText(Type::kPoseEuler, std::string("pose_euler { yaw_deg: ") + text + " }");
    return std::get<uc::PoseEuler>(*judged.value()).yaw_deg;
  };
  EXPECT_EQ(yaw("180"), 180.0F);
  EXPECT_EQ(yaw("181"), -179.0F);
  EXPECT_EQ(yaw("-540"), 180.0F);
  EXPECT_EQ(yaw("720"), 0.0F);
  EXPECT_TRUE(yaw("3e38").has_value());
}

TEST(Values, TakeAbsurdTimesAsUnknown) {
  for (const std::string_view time : {"-1", "4102444800000000"}) {
    const Judgement judged = JudgeText(
        Type::kHeading, "metadata { sampled_at_unix_us: " + std::string(time) + " } heading {}");
    EXPECT_EQ(judged.metadata.sampled_at_us, 0);
    EXPECT_FALSE(judged.metadata.timed());
    EXPECT_EQ(judged.times_unknown, 1U);
  }
  const Judgement last =
      JudgeText(Type::kHeading, "metadata { sampled_at_unix_us: 4102444799999999 } heading {}");
  EXPECT_EQ(last.metadata.sampled_at_us, 4'102'444'799'999'999);
}

TEST(Values, CountTheMemoryOfTheirTexts) {
  const Judgement shortest = JudgeText(Type::kUncrewFlightMode, "uncrew_flight_mode { mode: 'A' }");
  EXPECT_EQ(model::HeldBytes(*shortest.value()), 0U);
  const Judgement longer = JudgeText(
      Type::kUncrewFlightMode, "uncrew_flight_mode { detail: '" + std::string(4096, 'x') + "' }");
  EXPECT_GE(model::HeldBytes(*longer.value()), 4096U);
  const Judgement set = JudgeText(Type::kOperatorRequests,
                                  "operator_action_requests { requests { request_id: 'r' text: '" +
                                      std::string(100, 'x') + "' confirm_delivery_ready {} } }");
  EXPECT_GE(model::HeldBytes(*set.value()), sizeof(uc::OperatorActionRequest) + 100);
}

}  // namespace
}  // namespace uplink::uncrew
