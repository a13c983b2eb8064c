// Telemetry, events and logs: which is which, of what class, and what is kept of their own form.
#include <bit>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::RejectReason;
using model::cyberwave::DriverLog;
using model::cyberwave::Event;
using model::cyberwave::LogLevel;
using model::cyberwave::Mark;
using model::cyberwave::MarkKind;
using model::cyberwave::Report;
using model::cyberwave::ReportKind;
using test::BodyOf;
using test::JudgeOn;

Judgement Telemetry(const std::string& members) {
  return JudgeOn("telemetry", "{" + members + "}");
}

std::string LowFirst(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i) & 0xFFU);
  return text;
}

/// A frame of an edge's bridge whose head says to be `head_bytes` longer than it is.
std::string Frame(const std::string& head, const std::string& content, std::size_t more = 0) {
  const std::string stamps =
      LowFirst(std::bit_cast<std::uint64_t>(1'795'362'733.5), 8) + LowFirst(0, 8);
  return LowFirst(stamps.size() + head.size() + more, 4) + stamps + head + content;
}

constexpr auto kJson = R"({"content_type":"application/json"})";

TEST(CyberwaveTelemetry, ReadsMarks) {
  const Judgement judgement = Telemetry(
      R"("type":"telemetry_end","sensor":"front","recording_boundary":true,"session_id":"s")");
  EXPECT_EQ(judgement.message_class, MessageClass::kDurable);
  EXPECT_EQ(judgement.head.session_id, "s");
  const Mark mark = BodyOf<Mark>(judgement);
  EXPECT_EQ(mark.kind, MarkKind::kTelemetryEnd);
  EXPECT_EQ(mark.sensor, "front");
  EXPECT_TRUE(mark.recording_boundary);
  EXPECT_EQ(mark.detail, R"({"type":"telemetry_end","sensor":"front","recording_boundary":true,)"
                         R"("session_id":"s"})");
  EXPECT_EQ(BodyOf<Mark>(Telemetry(R"("type":"connected")")).kind, MarkKind::kConnected);
  EXPECT_EQ(BodyOf<Mark>(Telemetry(R"("type":"telemetry_start")")).kind, MarkKind::kTelemetryStart);
  EXPECT_EQ(BodyOf<Mark>(Telemetry(R"("type":"disconnected")")).kind, MarkKind::kDisconnected);
  EXPECT_EQ(BodyOf<Mark>(Telemetry(R"("type":"initial_observation")")).kind,
            MarkKind::kInitialObservation);
}

TEST(CyberwaveTelemetry, TakesEverythingElseForAnEvent) {
  for (const std::string type :
       {"camera_stored", "audio_started", "video_start_timestamp", "Connected", "robot_state"}) {
    const Judgement judgement = Telemetry(R"("type":")" + type + R"(","sender":"edge")");
    EXPECT_EQ(judgement.message_class, MessageClass::kDurable);
    EXPECT_EQ(BodyOf<Event>(judgement),
              (Event{.type = type,
                     .source = "edge",
                     .detail = R"({"type":")" + type + R"(","sender":"edge"})"}));
  }
}

TEST(CyberwaveTelemetry, ReadsReportsAsLive) {
  const Judgement motors = Telemetry(R"("type":"motor_status","motors":{"m1":{"temp_c":40}})");
  EXPECT_EQ(motors.message_class, MessageClass::kLive);
  const Report report = BodyOf<Report>(motors);
  EXPECT_EQ(report.kind, ReportKind::kMotorStatus);
  EXPECT_EQ(report.name, "motor_status");
  EXPECT_EQ(report.detail, R"({"type":"motor_status","motors":{"m1":{"temp_c":40}}})");
  EXPECT_EQ(BodyOf<Report>(Telemetry(R"("type":"driver_info")")).kind, ReportKind::kDriverInfo);
}

TEST(CyberwaveTelemetry, ReadsCategoriesAsLive) {
  const Judgement errors =
      Telemetry(R"("telemetry_type":"errors","data":{"errors":[{"code":"E1"}]})");
  EXPECT_EQ(errors.message_class, MessageClass::kLive);
  EXPECT_EQ(BodyOf<Report>(errors).name, "errors");
  EXPECT_EQ(BodyOf<Report>(errors).detail, R"({"errors":[{"code":"E1"}]})");
  const Report battery = BodyOf<Report>(
      Telemetry(R"("telemetry_type":"battery","data":{"level":103,"charging":false})"));
  EXPECT_EQ(battery.battery_percent, 100);
  EXPECT_EQ(battery.battery_charging, false);
  EXPECT_EQ(battery.detail, R"({"level":1E2,"charging":false})");
  EXPECT_EQ(BodyOf<Report>(Telemetry(R"("telemetry_type":"x")")).detail, "{}");
  EXPECT_TRUE(
      std::holds_alternative<Event>(*Telemetry(R"("type":"x","telemetry_type":"battery")").body()));
}

TEST(CyberwaveTelemetry, ShowsNoAbsurdBatteryInTheDetail) {
  const Judgement judgement =
      Telemetry(R"("telemetry_type":"battery","data":{"level":8150,"charging":true})");
  const Report battery = BodyOf<Report>(judgement);
  EXPECT_FALSE(battery.battery_percent);
  EXPECT_EQ(battery.detail, R"({"level":null,"charging":true})");
  EXPECT_EQ(judgement.dropped.size(), 1U);
}

TEST(CyberwaveLog, ReadsLevelsInAnyCase) {
  const auto level = [](const std::string& word) {
    return BodyOf<DriverLog>(JudgeOn("driverlog", R"({"message":"m","level":")" + word + "\"}"));
  };
  EXPECT_EQ(level("debug").level, LogLevel::kDebug);
  EXPECT_EQ(level("Info").level, LogLevel::kInfo);
  EXPECT_EQ(level("WARNING").level, LogLevel::kWarning);
  EXPECT_EQ(level("ERROR").level, LogLevel::kError);
  EXPECT_EQ(level("CRITICAL").level, LogLevel::kCritical);
  EXPECT_EQ(level("notice").level, LogLevel::kUnknown);
  EXPECT_EQ(level("Notice").level_text, "Notice");
}

TEST(CyberwaveLog, KeepsTheRestInTheDetail) {
  for (const std::string tail : {"driverlog", "telemetry"}) {
    const Judgement judgement =
        JudgeOn(tail, R"({"type":"driver_log","message":"overcurrent","level":"ERROR",)"
                      R"("container_name":"so101","source":"edge","driver_image":"so101:1"})");
    EXPECT_EQ(judgement.message_class, MessageClass::kDurable);
    const DriverLog log = BodyOf<DriverLog>(judgement);
    EXPECT_EQ(log.message, "overcurrent");
    EXPECT_EQ(log.container_name, "so101");
    EXPECT_EQ(log.source, "edge");
    EXPECT_EQ(log.detail, R"({"type":"driver_log","driver_image":"so101:1","level":"ERROR",)"
                          R"("container_name":"so101","source":"edge"})");
  }
}

TEST(CyberwaveEvent, IsDurableButForARobotsState) {
  const Judgement event =
      JudgeOn("event", R"({"event_type":"zone","source":"worker","data":{"zone":"a"}})");
  EXPECT_EQ(event.message_class, MessageClass::kDurable);
  EXPECT_EQ(BodyOf<Event>(event),
            (Event{.type = "zone",
                   .source = "worker",
                   .detail = R"({"event_type":"zone","source":"worker","data":{"zone":"a"}})"}));
  const Judgement state =
      JudgeOn("event", R"({"event_type":"robot_state","data":{"state":"idle","v":null}})");
  EXPECT_EQ(state.message_class, MessageClass::kLive);
  const Report report = BodyOf<Report>(state);
  EXPECT_EQ(report.kind, ReportKind::kRobotState);
  EXPECT_EQ(report.detail, R"({"state":"idle","v":null})");
}

TEST(CyberwaveEvent, ComesInAFrameOfTheBridge) {
  const Judgement judgement = JudgeOn("event", Frame(kJson, R"({"event_type":"e","data":{}})"));
  EXPECT_EQ(BodyOf<Event>(judgement).detail, R"({"event_type":"e","data":{}})");
  EXPECT_EQ(judgement.head.timestamp_us, 1'795'362'733'500'000);
  EXPECT_TRUE(judgement.sign_of_life);
  EXPECT_EQ(JudgeOn("event", Frame(kJson, R"({"event_type":"e","timestamp":5})")).head.timestamp_us,
            5'000'000);
}

TEST(CyberwaveEvent, RejectsAFrameThatIsNotGood) {
  const std::string good = R"({"event_type":"e"})";
  for (const std::string& frame :
       {Frame(R"({"content_type":"image/jpeg"})", good), Frame("{}", good), Frame("", good),
        Frame("[]", good), Frame(R"({"content_type":1})", good), Frame(kJson, ""),
        Frame(kJson, R"({"n":NaN})"), Frame(kJson, good, good.size() + 1),
        LowFirst(15, 4) + std::string(40, 'x'), LowFirst(0, 4), LowFirst(0xFFFFFF, 4),
        std::string(4, '\0'), std::string(3, '\0') + "x"}) {
    const Judgement judgement = JudgeOn("event", frame);
    ASSERT_NE(judgement.rejection(), nullptr);
    const RejectReason reason = judgement.rejection()->reason;
    EXPECT_TRUE(reason == RejectReason::kMalformed || reason == RejectReason::kTextNotUtf8);
  }
  EXPECT_EQ(JudgeOn("event", Frame(kJson, "[]")).rejection()->reason, RejectReason::kTypeMismatch);
  EXPECT_EQ(JudgeOn("event", Frame(kJson, "\"\xFF\"")).rejection()->reason,
            RejectReason::kTextNotUtf8);
  EXPECT_NE(JudgeOn("telemetry", Frame(kJson, R"({"type":"x"})")).rejection(), nullptr);
}

TEST(CyberwaveEvent, TakesAnAbsurdTimeOfItsFrameAsUnknown) {
  std::string frame = Frame(kJson, R"({"event_type":"e"})");
  frame.replace(4, 8, LowFirst(std::bit_cast<std::uint64_t>(-5.0), 8));
  const Judgement judgement = JudgeOn("event", frame);
  EXPECT_EQ(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.head.timestamp_us, 0);
  EXPECT_EQ(judgement.times_unknown, 1U);
}

TEST(CyberwaveDetail, ReplacesControlCharactersAndCountsEachOnce) {
  const Judgement judgement = JudgeOn(
      "event", R"({"event_type":"e\u0001","source":"s\u0002","data":{"a\u0003":["\u0004\t"]}})");
  const Event event = BodyOf<Event>(judgement);
  const std::string mark = "\xEF\xBF\xBD";
  EXPECT_EQ(event.type, "e" + mark);
  EXPECT_EQ(event.detail, R"({"event_type":"e)" + mark + R"(","source":"s)" + mark +
                              R"(","data":{"a)" + mark + R"(":[")" + mark + R"(\t"]}})");
  EXPECT_EQ(judgement.control_characters, 4U);
}

TEST(CyberwaveDetail, KeepsNumbersToTheLastBit) {
  const Judgement judgement =
      JudgeOn("event", R"({"event_type":"e","n":[9007199254740993,0.1,-0.0,1795362440.281389]})");
  EXPECT_EQ(BodyOf<Event>(judgement).detail,
            R"({"event_type":"e","n":[9007199254740993,1E-1,-0E0,1.795362440281389E9]})");
}

TEST(CyberwaveDetail, PutsNullInPlaceOfWhatALiveMessageGoesWithout) {
  const Judgement judgement =
      Telemetry(R"("type":"motor_status","a":1e400,"b":["\u0000",2],"c\u0000":3,"d":4)");
  EXPECT_EQ(BodyOf<Report>(judgement).detail,
            R"({"type":"motor_status","a":null,"b":[null,2],"d":4})");
  EXPECT_EQ(judgement.dropped.size(), 3U);
}

TEST(CyberwaveDetail, WhatIsTooDeepIsTextInADurableMessage) {
  const auto nested = [](std::size_t depth) {
    return R"({"event_type":"e","v":)" + std::string(depth, '[') + R"("a\n",null)" +
           std::string(depth, ']') + "}";
  };
  const std::size_t shown = kShownDepthMax - 1;
  EXPECT_EQ(BodyOf<Event>(JudgeOn("event", nested(shown))).detail, nested(shown));
  EXPECT_EQ(BodyOf<Event>(JudgeOn("event", nested(shown + 2))).detail,
            R"({"event_type":"e","v":)" + std::string(shown, '[') + R"("[[\"a\\n\",null]]")" +
                std::string(shown, ']') + "}");
  const Judgement wrong = JudgeOn("event", R"({"event_type":"e","v":)" + std::string(25, '[') +
                                               "1e400" + std::string(25, ']') + "}");
  ASSERT_NE(wrong.rejection(), nullptr);
  EXPECT_EQ(wrong.rejection()->reason, RejectReason::kNotFinite) << "also within such a text";
}

TEST(CyberwaveEvent, IsKeptInAFewTimesItsBytes) {
  // A control character has one byte, and what is kept in its place three; fractions grow by half.
  const std::string start = R"({"event_type":"e","v":)";
  std::string fractions = "[1.1";
  for (int i = 0; i < 1'000; ++i) fractions += ",1.1";
  for (const std::string& value : {"\"" + std::string(1'000, '\x7f') + "\"", fractions + "]"}) {
    const std::string payload = start + value + "}";
    const auto event = BodyOf<Event>(JudgeOn("event", payload));
    EXPECT_GT(event.detail.size(), payload.size());
    EXPECT_LE(event.detail.size(), kReplacementBytes * payload.size());
  }
}

}  // namespace
}  // namespace uplink::cyberwave
