// Each rule of a field by its name, at its limit and past it.
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "schema/uncrew/judge.h"
#include "tests/unit/schema/uncrew/requests.h"
#include "tests/unit/schema/uncrew/samples.h"

namespace uplink::uncrew {
namespace {

using model::RejectReason;
using test::RequestOf;
using test::Type;

Judgement JudgeText(Type type, const std::string& text) {
  return Judge(type, RequestOf(type, text));
}

/// What is wrong with a sample, whether it was rejected or a field dropped.
const model::Rejection* ViolationIn(const Judgement& judged) {
  if (judged.rejection() != nullptr) return judged.rejection();
  return judged.dropped.empty() ? nullptr : &judged.dropped.front();
}

/// `a.b.c` as a text that holds `value` there.
std::string Holding(std::string_view path, std::string_view value) {
  std::string text;
  std::string close;
  for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
    text.append(path.substr(0, dot)).append(" { ");
    close.append(" }");
    path.remove_prefix(dot + 1);
  }
  return text.append(path).append(": ").append(value).append(close);
}

/// A number's rule.
struct NumberRule {
  Type type;
  std::string path;
  std::vector<std::string> at;
  std::vector<std::string> past;
};

void PrintTo(const NumberRule& rule, std::ostream* out) { *out << rule.path; }

class Numbers : public ::testing::TestWithParam<NumberRule> {};

TEST_P(Numbers, PassUpToTheirLimitAndNoFurther) {
  const NumberRule& rule = GetParam();
  for (const std::string& value : rule.at) {
    const Judgement judged = JudgeText(rule.type, Holding(rule.path, value));
    EXPECT_EQ(ViolationIn(judged), nullptr) << value;
  }
  for (const std::string& value : rule.past) {
    const Judgement judged = JudgeText(rule.type, Holding(rule.path, value));
    const model::Rejection* violation = ViolationIn(judged);
    ASSERT_NE(violation, nullptr) << value;
    const bool infinite = value.find("inf") != std::string::npos;
    EXPECT_EQ(violation->reason, infinite ? RejectReason::kNotFinite : RejectReason::kOutOfRange);
    EXPECT_EQ(violation->field, rule.path);
  }
}

const std::vector<std::string> kFinite = {"-3e38", "nan", "3e38"};
const std::vector<std::string> kInfinite = {"inf", "-inf"};
const std::vector<std::string> kHeights = {"-12000", "nan", "100000"};
const std::vector<std::string> kNoHeights = {"-12000.1", "100000.1", "inf", "-inf"};
const std::vector<std::string> kThousands = {"-1000", "nan", "1000"};
const std::vector<std::string> kNoThousands = {"-1000.1", "1000.1", "inf"};
const std::vector<std::string> kFromZero = {"0", "nan", "3e38"};
const std::vector<std::string> kBelowZero = {"-0.001", "inf", "-inf"};
const std::vector<std::string> kTemperatures = {"-273.1", "nan", "1000"};
const std::vector<std::string> kNoTemperatures = {"-273.2", "1000.1", "inf"};
const std::vector<std::string> kVolts = {"0", "nan", "10000"};
const std::vector<std::string> kNoVolts = {"-0.001", "10000.1", "inf"};
const std::vector<std::string> kAmperes = {"-10000", "nan", "10000"};
const std::vector<std::string> kNoAmperes = {"-10000.1", "10000.1", "inf"};
const std::vector<std::string> kPercents = {"-5", "nan", "105"};
const std::vector<std::string> kNoPercents = {"-5.01", "105.01", "inf"};

INSTANTIATE_TEST_SUITE_P(
    Motion, Numbers,
    ::testing::Values(
        NumberRule{Type::kAltitude, "altitude.altitude_monotonic_m", kHeights, kNoHeights},
        NumberRule{Type::kAltitude, "altitude.altitude_amsl_m", kHeights, kNoHeights},
        NumberRule{Type::kAltitude, "altitude.altitude_local_m", kHeights, kNoHeights},
        NumberRule{Type::kAltitude, "altitude.altitude_relative_m", kHeights, kNoHeights},
        NumberRule{Type::kAltitude, "altitude.altitude_terrain_m", kHeights, kNoHeights},
        NumberRule{Type::kAltitude, "altitude.bottom_clearance_m", kFromZero, kBelowZero},
        NumberRule{
            Type::kPosition, "position.latitude_deg", {"-90", "90"}, {"-90.001", "90.001", "inf"}},
        NumberRule{Type::kPosition,
                   "position.longitude_deg",
                   {"-180", "180"},
                   {"-180.001", "180.001", "inf"}},
        NumberRule{Type::kPosition, "position.absolute_altitude_m", kHeights, kNoHeights},
        NumberRule{Type::kPosition, "position.relative_altitude_m", kHeights, kNoHeights},
        NumberRule{Type::kVelocityNed, "velocity_ned.north_m_s", kThousands, kNoThousands},
        NumberRule{Type::kVelocityNed, "velocity_ned.east_m_s", kThousands, kNoThousands},
        NumberRule{Type::kVelocityNed, "velocity_ned.down_m_s", kThousands, kNoThousands},
        NumberRule{Type::kHeading, "heading.heading_deg", {"-1e300", "nan", "1e300"}, kInfinite},
        NumberRule{Type::kPoseEuler, "pose_euler.roll_deg", kFinite, kInfinite},
        NumberRule{Type::kPoseEuler, "pose_euler.pitch_deg", kFinite, kInfinite},
        NumberRule{Type::kPoseEuler, "pose_euler.yaw_deg", kFinite, kInfinite},
        NumberRule{Type::kImu, "imu.acceleration_m_s2.forward", kFinite, kInfinite},
        NumberRule{Type::kImu, "imu.angular_velocity_rad_s.right", kThousands, kNoThousands},
        NumberRule{Type::kImu, "imu.magnetic_field_gauss.down", kFinite, kInfinite},
        NumberRule{Type::kImu, "imu.temperature_degc", kTemperatures, kNoTemperatures},
        NumberRule{Type::kOdometry, "odometry.position_m.x", kFinite, kInfinite},
        NumberRule{Type::kOdometry, "odometry.q.w", kFinite, kInfinite},
        NumberRule{Type::kOdometry, "odometry.velocity_m_s.y", kThousands, kNoThousands},
        NumberRule{Type::kOdometry, "odometry.angular_velocity_rad_s.yaw", kThousands,
                   kNoThousands}));

INSTANTIATE_TEST_SUITE_P(
    Devices, Numbers,
    ::testing::Values(
        NumberRule{Type::kBattery, "battery.temperature_degc", kTemperatures, kNoTemperatures},
        NumberRule{Type::kBattery, "battery.voltage_v", kVolts, kNoVolts},
        NumberRule{Type::kBattery, "battery.current_battery_a", kAmperes, kNoAmperes},
        NumberRule{Type::kBattery, "battery.capacity_consumed_ah", kFinite, kInfinite},
        NumberRule{Type::kBattery, "battery.remaining_percent", kPercents, kNoPercents},
        NumberRule{Type::kBattery, "battery.time_remaining_s", kFromZero, kBelowZero},
        NumberRule{Type::kDistanceSensor, "distance_sensor.minimum_distance_m", kFromZero,
                   kBelowZero},
        NumberRule{Type::kDistanceSensor, "distance_sensor.maximum_distance_m", kFromZero,
                   kBelowZero},
        NumberRule{Type::kDistanceSensor, "distance_sensor.current_distance_m", kFromZero,
                   kBelowZero},
        NumberRule{Type::kDistanceSensor, "distance_sensor.orientation.roll_deg", kFinite,
                   kInfinite},
        NumberRule{Type::kGpsInfo, "gps_info.num_satellites", {"0", "255"}, {"-1", "256"}},
        NumberRule{Type::kVideoStreamSettings, "video_stream_settings.frame_rate_hz", kFinite,
                   kInfinite},
        NumberRule{Type::kVideoStreamSettings, "video_stream_settings.horizontal_fov_deg", kFinite,
                   kInfinite},
        NumberRule{Type::kWinchReelStatus, "winch_reel_status.line_remaining_m", kFromZero,
                   kBelowZero},
        NumberRule{Type::kWinchStatus, "winch_status.line_length_m", kFromZero, kBelowZero},
        NumberRule{Type::kWinchStatus, "winch_status.speed_m_s", kThousands, kNoThousands},
        NumberRule{Type::kWinchStatus, "winch_status.tension_kg", kFromZero, kBelowZero},
        NumberRule{Type::kWinchStatus, "winch_status.voltage_v", kVolts, kNoVolts},
        NumberRule{Type::kWinchStatus, "winch_status.current_a", kAmperes, kNoAmperes},
        NumberRule{
            Type::kWinchStatus, "winch_status.temperature_c", {"-273", "1000"}, {"-274", "1001"}},
        NumberRule{
            Type::kCurrentMissionItem, "current_mission_item.current", {"0", "2147483647"}, {"-1"}},
        NumberRule{
            Type::kCurrentMissionItem, "current_mission_item.total", {"0", "2147483647"}, {"-1"}}));

/// Any other rule: a request that keeps it and one that breaks it.
struct Rule {
  std::string name;
  Type type;
  std::string good;
  std::string bad;
  RejectReason reason;
  std::string field;
};

void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.name; }

class Rejecting : public ::testing::TestWithParam<Rule> {};

TEST_P(Rejecting, TheGoodRequestPassesAndTheBadOneIsRejected) {
  const Rule& rule = GetParam();
  const Judgement good = JudgeText(rule.type, rule.good);
  EXPECT_EQ(good.rejection(), nullptr) << good.rejection()->field << good.rejection()->detail;
  EXPECT_TRUE(good.dropped.empty());
  const Judgement bad = JudgeText(rule.type, rule.bad);
  ASSERT_NE(bad.rejection(), nullptr);
  EXPECT_EQ(bad.rejection()->reason, rule.reason) << bad.rejection()->detail;
  EXPECT_EQ(bad.rejection()->field, rule.field);
  EXPECT_TRUE(bad.dropped.empty());
}

std::string Long(std::size_t bytes) { return '"' + std::string(bytes, 'x') + '"'; }

/// A rule of a text's length.
Rule TextRule(Type type, const std::string& path, std::size_t bytes_max,
              const std::string& with = {}) {
  return {path,
          type,
          with + Holding(path, Long(bytes_max)),
          with + Holding(path, Long(bytes_max + 1)),
          RejectReason::kTextTooLong,
          path};
}

std::string Alerts(std::size_t count) {
  std::string text = "alerts {";
  for (std::size_t i = 0; i < count; ++i) {
    text += " alerts { alert_id: 'a" + std::to_string(i) + "' battery {} }";
  }
  return text + " }";
}
std::string Alert(const std::string& rest) { return "alerts { alerts { " + rest + " } }"; }
std::string Requests(std::size_t count) {
  std::string text = "operator_action_requests {";
  for (std::size_t i = 0; i < count; ++i) {
    text += " requests { request_id: 'r" + std::to_string(i) + "' confirm_delivery_ready {} }";
  }
  return text + " }";
}
std::string Request(const std::string& rest) {
  return "operator_action_requests { requests { confirm_delivery_ready {} " + rest + " } }";
}
std::string Covariance(std::size_t values, const std::string& value = "0") {
  std::string text = "odometry { pose_covariance { covariance_matrix: [";
  for (std::size_t i = 0; i < values; ++i) text += (i == 0 ? "" : ",") + value;
  return text + "] } }";
}

std::string NameOf(const ::testing::TestParamInfo<Rule>& each) {
  std::string name = std::to_string(each.index) + "_" + each.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    Texts, Rejecting,
    ::testing::Values(
        TextRule(Type::kConnectionEvent, "connection_event.link", 256,
                 "connection_event { text: 't' } "),
        TextRule(Type::kConnectionEvent, "connection_event.text", 4096),
        TextRule(Type::kCurrentMissionItem, "current_mission_item.mission_id", 128),
        TextRule(Type::kError, "error.code", 256, "error { text: 't' } "),
        TextRule(Type::kError, "error.text", 4096),
        TextRule(Type::kError, "error.source", 256, "error { text: 't' } "),
        TextRule(Type::kError, "error.command_id", 128, "error { text: 't' } "),
        TextRule(Type::kStatusText, "status_text.text", 4096),
        TextRule(Type::kUncrewFlightMode, "uncrew_flight_mode.mode", 256),
        TextRule(Type::kUncrewFlightMode, "uncrew_flight_mode.detail", 4096),
        TextRule(Type::kVideoStreamSettings, "video_stream_settings.uri", 4096),
        TextRule(Type::kWinchReelStatus, "winch_reel_status.state", 256),
        TextRule(Type::kCommandResult, "command_id", 128, "status {} "),
        TextRule(Type::kCommandResult, "status.code", 256, "command_id: 'c' "),
        TextRule(Type::kCommandResult, "status.text", 4096, "command_id: 'c' "),
        Rule{"alert_id", Type::kAlerts, Alert("battery {} alert_id: " + Long(128)),
             Alert("battery {} alert_id: " + Long(129)), RejectReason::kTextTooLong,
             "alerts[0].alert_id"},
        Rule{"alert text", Type::kAlerts, Alert("battery {} text: " + Long(4096)),
             Alert("battery {} text: " + Long(4097)), RejectReason::kTextTooLong, "alerts[0].text"},
        Rule{"condition", Type::kAlerts, Alert("battery { condition: " + Long(256) + " }"),
             Alert("battery { condition: " + Long(257) + " }"), RejectReason::kTextTooLong,
             "alerts[0].battery.condition"},
        Rule{"cause", Type::kAlerts, Alert("flight_termination { cause: " + Long(4096) + " }"),
             Alert("flight_termination { cause: " + Long(4097) + " }"), RejectReason::kTextTooLong,
             "alerts[0].flight_termination.cause"},
        Rule{"request_id", Type::kOperatorRequests, Request("request_id: " + Long(128)),
             Request("request_id: " + Long(129)), RejectReason::kTextTooLong,
             "operator_action_requests[0].request_id"},
        Rule{"request text", Type::kOperatorRequests,
             Request("request_id: 'r' text: " + Long(4096)),
             Request("request_id: 'r' text: " + Long(4097)), RejectReason::kTextTooLong,
             "operator_action_requests[0].text"},
        Rule{"no NUL", Type::kStatusText, "status_text { text: 'a' }",
             "status_text { text: '\\000' }", RejectReason::kTextNotUtf8, "status_text.text"},
        Rule{"UTF-8", Type::kStatusText, "status_text { text: '\\303\\244' }",
             "status_text { text: '\\303' }", RejectReason::kMalformed, ""}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Contents, Rejecting,
    ::testing::Values(
        Rule{"a status has a text", Type::kStatusText, "status_text { text: 'a' }",
             "status_text {}", RejectReason::kMissingField, "status_text.text"},
        Rule{"an error has a text", Type::kError, "error { text: 'a' }", "error { code: 'a' }",
             RejectReason::kMissingField, "error.text"},
        Rule{"a connection event has a text", Type::kConnectionEvent,
             "connection_event { text: 'a' }", "connection_event { link: 'a' }",
             RejectReason::kMissingField, "connection_event.text"},
        Rule{"a result has its command", Type::kCommandResult, "command_id: 'c' status {}",
             "status {}", RejectReason::kMissingField, "command_id"},
        Rule{"a request has an id", Type::kOperatorRequests, Request("request_id: 'r'"),
             Request(""), RejectReason::kMissingField, "operator_action_requests[0].request_id"},
        Rule{"an alert has a kind", Type::kAlerts, Alert("battery {}"), Alert("alert_id: 'a'"),
             RejectReason::kUnknownVariant, "alerts[0]"},
        Rule{"a request has a kind", Type::kOperatorRequests, Requests(1),
             "operator_action_requests { requests { request_id: 'r' } }",
             RejectReason::kUnknownVariant, "operator_action_requests[0]"},
        Rule{"alerts", Type::kAlerts, Alerts(64), Alerts(65), RejectReason::kTooManyItems,
             "alerts"},
        Rule{"requests", Type::kOperatorRequests, Requests(16), Requests(17),
             RejectReason::kTooManyItems, "operator_action_requests"},
        Rule{"no alerts", Type::kAlerts, "alerts {}", "", RejectReason::kMissingField, "alerts"},
        Rule{"no requests", Type::kOperatorRequests, "operator_action_requests {}", "",
             RejectReason::kMissingField, "operator_action_requests"},
        Rule{"alert ids", Type::kAlerts,
             "alerts { alerts { alert_id: 'a' battery {} } alerts { alert_id: 'b' battery {} } }",
             "alerts { alerts { alert_id: 'a' battery {} } alerts { alert_id: 'a' battery {} } }",
             RejectReason::kDuplicateKey, "alerts[1].alert_id"},
        Rule{"alert ids of ours", Type::kAlerts,
             "alerts { alerts { battery {} } alerts { battery { battery_id: 1 } } }",
             "alerts { alerts { battery {} } alerts { battery {} } }", RejectReason::kDuplicateKey,
             "alerts[1].alert_id"},
        Rule{"request ids", Type::kOperatorRequests, Requests(2),
             "operator_action_requests { requests { request_id: 'r' confirm_delivery_ready {} } "
             "requests { request_id: 'r' confirm_delivery_complete {} } }",
             RejectReason::kDuplicateKey, "operator_action_requests[1].request_id"},
        Rule{"alert percent", Type::kAlerts, Alert("battery_percentage { remaining_percent: 105 }"),
             Alert("battery_percentage { remaining_percent: 105.5 }"), RejectReason::kOutOfRange,
             "alerts[0].battery_percentage.remaining_percent"},
        Rule{"alert threshold", Type::kAlerts,
             Alert("battery_percentage { threshold_percent: -5 }"),
             Alert("battery_percentage { threshold_percent: -inf }"), RejectReason::kNotFinite,
             "alerts[0].battery_percentage.threshold_percent"},
        Rule{"mission item", Type::kCurrentMissionItem,
             "current_mission_item { current: 3 total: 3 }",
             "current_mission_item { current: 4 total: 3 }", RejectReason::kOutOfRange,
             "current_mission_item.current"},
        Rule{"covariance of 21", Type::kOdometry, Covariance(21), Covariance(22),
             RejectReason::kTooManyItems, "odometry.pose_covariance.covariance_matrix"},
        Rule{"covariance or none", Type::kOdometry, Covariance(0), Covariance(20),
             RejectReason::kTooFewItems, "odometry.pose_covariance.covariance_matrix"},
        Rule{"covariance is finite", Type::kOdometry, Covariance(21, "1"), Covariance(21, "inf"),
             RejectReason::kNotFinite, "odometry.pose_covariance.covariance_matrix[0]"}),
    NameOf);

TEST(Dropping, NamesTheInvalidFieldAndKeepsTheRest) {
  const Judgement judged =
      JudgeText(Type::kBattery, "battery { id: 1 voltage_v: -1 remaining_percent: 50 }");
  ASSERT_NE(judged.value(), nullptr);
  const auto& battery = std::get<model::uncrew::Battery>(*judged.value());
  EXPECT_EQ(battery.voltage_v, std::nullopt);
  EXPECT_EQ(battery.remaining_percent, 50.0F);
  ASSERT_EQ(judged.dropped.size(), 1U);
  EXPECT_EQ(judged.dropped[0].field, "battery.voltage_v");
  EXPECT_EQ(judged.dropped[0].reason, RejectReason::kOutOfRange);
}

TEST(Dropping, RejectsASampleOfWhichNothingElseIsLeft) {
  const Judgement judged = JudgeText(Type::kBattery, "battery { id: 1 voltage_v: -1 }");
  ASSERT_NE(judged.rejection(), nullptr);
  EXPECT_EQ(judged.rejection()->field, "battery.voltage_v");
}

TEST(Dropping, KeepsThatThereIsNoGps) {
  const Judgement judged = JudgeText(Type::kGpsInfo, "gps_info { num_satellites: -1 }");
  ASSERT_NE(judged.value(), nullptr);
  EXPECT_EQ(judged.dropped.size(), 1U);
}

TEST(Requests, AreTooLargePast64Kib) {
  const auto of_size = [](std::size_t bytes) {
    // Field 1023 with a length of three bytes.
    std::string request = RequestOf(Type::kHeading, "heading { heading_deg: 1 }");
    const std::size_t rest = bytes - request.size() - 5;
    request += std::string("\xfa\x3f", 2);
    for (const std::size_t part : {rest & 127U, (rest >> 7U) & 127U}) {
      request += static_cast<char>(part | 128U);
    }
    request += static_cast<char>(rest >> 14U);
    return request + std::string(rest, 'x');
  };
  EXPECT_NE(Judge(Type::kHeading, of_size(65'536)).value(), nullptr);
  const Judgement judged = Judge(Type::kHeading, of_size(65'537));
  ASSERT_NE(judged.rejection(), nullptr);
  EXPECT_EQ(judged.rejection()->reason, RejectReason::kPayloadTooLarge);
  EXPECT_FALSE(judged.decoded);
}

TEST(Secrets, LeaveTheUriOfAVideo) {
  const auto kept = [](const std::string& uri) {
    const Judgement judged =
        JudgeText(Type::kVideoStreamSettings, "video_stream_settings { uri: '" + uri + "' }");
    return std::get<model::uncrew::VideoStreamSettings>(*judged.value()).uri;
  };
  EXPECT_EQ(kept("rtsp://user:pw@cam:554/live?x=1#y"), "rtsp://cam:554/live?x=1#y");
  EXPECT_EQ(kept("rtsp://user@cam/"), "rtsp://cam/");
  EXPECT_EQ(kept("rtsp://a:b@c@cam/"), "rtsp://cam/");
  EXPECT_EQ(kept("user:pw@cam/live"), "cam/live");
  EXPECT_EQ(kept("rtsp://cam/user=me&password=pw&channel=1"),
            "rtsp://cam/user=&password=&channel=1");
  EXPECT_EQ(kept("http://cam/live?Password=pw"), "http://cam/live?Password=");
  EXPECT_EQ(kept("rtsp://cam/a@b"), "rtsp://cam/a@b");
  EXPECT_EQ(kept("udp://:5600"), "udp://:5600");
}

TEST(Secrets, AreNotQuotedInWhatIsTold) {
  const Judgement judged = JudgeText(Type::kVideoStreamSettings,
                                     "video_stream_settings { uri: 'rtsp://me:hunter2@cam\\000' }");
  ASSERT_NE(judged.rejection(), nullptr);
  EXPECT_EQ(judged.rejection()->detail.find("hunter2"), std::string::npos);
  EXPECT_FALSE(judged.may_be_kept);
  EXPECT_TRUE(JudgeText(Type::kHeading, "heading {}").may_be_kept);
}

}  // namespace
}  // namespace uplink::uncrew
