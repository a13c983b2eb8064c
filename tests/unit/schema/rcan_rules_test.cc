// RCAN's Robot State: each rule by its name, with a text that keeps it and one that breaks it.
#include <algorithm>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/json/render.h"
#include "schema/limits.h"
#include "schema/rcan/judge.h"
#include "schema/rcan/ruri.h"

namespace uplink::schema {
namespace {

using model::RejectReason;

constexpr std::string_view kRuri = "rcan://local.rcan/acme/arm/1";
constexpr std::size_t kBytesMax = std::size_t{64} * 1024;

/// A state with these members besides those that it must have.
std::string State(const std::string& members) {
  return R"({"ruri":"rcan://local.rcan/acme/arm/1","timestamp_us":1000)" +
         (members.empty() ? "" : "," + members) + "}";
}
std::string Joint(const std::string& members) {
  return State(R"("joints":[{"joint":"elbow","timestamp_us":5)" +
               (members.empty() ? "" : "," + members) + "}]");
}
std::string Joints(int count) {
  std::string list;
  for (int i = 0; i < count; ++i) {
    list += (i == 0 ? "" : ",") + std::string(R"({"joint":"j)") + std::to_string(i) +
            R"(","timestamp_us":1})";
  }
  return State("\"joints\":[" + list + "]");
}
std::string Nested(int depth) {
  return State("\"x\":" + std::string(static_cast<std::size_t>(depth), '[') +
               std::string(static_cast<std::size_t>(depth), ']'));
}

RcanJudgement JudgeOf(const std::string& text) { return JudgeRcanState(text, kRuri, kBytesMax); }

struct Rule {
  std::string name;
  std::string good;
  std::string bad;
  RejectReason reason;
  std::string field;
};

void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.name; }

/// A rule's name as GoogleTest wants it.
std::string NameOf(const ::testing::TestParamInfo<Rule>& each) {
  std::string name = each.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

class Rejecting : public ::testing::TestWithParam<Rule> {};

TEST_P(Rejecting, TheGoodTextPassesAndTheBadOneIsRejected) {
  const Rule& rule = GetParam();
  const RcanJudgement good = JudgeOf(rule.good);
  EXPECT_EQ(good.rejection(), nullptr) << good.rejection()->field << good.rejection()->detail;
  EXPECT_TRUE(good.dropped.empty());
  const RcanJudgement bad = JudgeOf(rule.bad);
  ASSERT_NE(bad.rejection(), nullptr);
  EXPECT_EQ(bad.rejection()->reason, rule.reason) << bad.rejection()->detail;
  EXPECT_EQ(bad.rejection()->field, rule.field);
  EXPECT_FALSE(bad.rejection()->detail.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Rules, Rejecting,
    ::testing::Values(
        Rule{"size", State("\"x\":\"" + std::string(65'000, 'a') + "\""),
             State("\"x\":\"" + std::string(66'000, 'a') + "\""), RejectReason::kPayloadTooLarge,
             ""},
        Rule{"json", State(""), "{", RejectReason::kMalformed, ""},
        Rule{"nothing after it", State("") + " \n", State("") + "x", RejectReason::kMalformed, ""},
        Rule{"not empty", State(""), "", RejectReason::kMalformed, ""},
        Rule{"bare NaN", State(R"("battery_v":1)"), State(R"("battery_v":NaN)"),
             RejectReason::kMalformed, ""},
        Rule{"bare Infinity", State(R"("battery_v":0)"), State(R"("battery_v":-Infinity)"),
             RejectReason::kMalformed, ""},
        Rule{"depth", Nested(31), Nested(32), RejectReason::kMalformed, ""},
        Rule{"utf-8", State(R"("joints":[{"joint":"Gr\u00fc\u00df","timestamp_us":1}])"),
             State("\"x\":\"\xFF\""), RejectReason::kTextNotUtf8, ""},
        Rule{"an object", State(""), "[]", RejectReason::kTypeMismatch, ""},
        Rule{"ruri there", State(""), R"({"timestamp_us":1})", RejectReason::kMissingField, "ruri"},
        Rule{"ruri a string", State(""), R"({"ruri":1,"timestamp_us":1})",
             RejectReason::kTypeMismatch, "ruri"},
        Rule{"ruri of the stream",
             R"({"ruri":"rcan://local.rcan/acme/arm/1?sig=x","timestamp_us":1})",
             R"({"ruri":"rcan://local.rcan/acme/arm/2","timestamp_us":1})",
             RejectReason::kIdentityMismatch, "ruri"},
        Rule{"ruri by its shorthand", R"({"ruri":"acme.arm.1","timestamp_us":1})",
             R"({"ruri":"acme.arm.1.2","timestamp_us":1})", RejectReason::kIdentityMismatch,
             "ruri"},
        Rule{"a joint once, also if it is invalid",
             State(R"("joints":[{"joint":"a","timestamp_us":1},{"joint":"b","timestamp_us":1}])"),
             State(R"("joints":[{"joint":"a"},{"joint":"a","timestamp_us":1}])"),
             RejectReason::kDuplicateKey, "joints[1].joint"},
        Rule{"ruri's length, without its signature",
             R"({"ruri":"rcan://local.rcan/acme/arm/1?sig=)" + std::string(5000, 'a') +
                 R"(","timestamp_us":1})",
             R"({"timestamp_us":1,"ruri":"rcan://)" + std::string(250, 'a') + "?sig=b\"}",
             RejectReason::kTextTooLong, "ruri"},
        Rule{"ruri's length", State(""),
             R"({"timestamp_us":1,"ruri":"rcan://)" + std::string(250, 'a') + "\"}",
             RejectReason::kTextTooLong, "ruri"},
        Rule{"time there", State(""), R"({"ruri":"acme.arm.1"})", RejectReason::kMissingField,
             "timestamp_us"},
        Rule{"time whole", R"({"ruri":"acme.arm.1","timestamp_us":78.0})",
             R"({"ruri":"acme.arm.1","timestamp_us":78.5})", RejectReason::kTypeMismatch,
             "timestamp_us"},
        Rule{"time not below 0", R"({"ruri":"acme.arm.1","timestamp_us":0})",
             R"({"ruri":"acme.arm.1","timestamp_us":-1})", RejectReason::kOutOfRange,
             "timestamp_us"},
        Rule{"time within 64 bits", R"({"ruri":"acme.arm.1","timestamp_us":9223372036854775807})",
             R"({"ruri":"acme.arm.1","timestamp_us":9223372036854775808})",
             RejectReason::kOutOfRange, "timestamp_us"},
        Rule{"numbers within a double", State(R"("battery_v":1e300)"),
             State(R"("battery_v":1e400)"), RejectReason::kNotFinite, "battery_v"},
        Rule{"exponents within bounds", State(R"("battery_v":1e-400)"),
             State(R"("battery_v":1e99999999999)"), RejectReason::kNotFinite, ""},
        Rule{"joints' count", Joints(256), Joints(257), RejectReason::kTooManyItems, "joints"},
        Rule{"a joint once",
             State(R"("joints":[{"joint":"a","timestamp_us":1},{"joint":"b","timestamp_us":1}])"),
             State(R"("joints":[{"joint":"a","timestamp_us":1},{"joint":"a","timestamp_us":2}])"),
             RejectReason::kDuplicateKey, "joints[1].joint"}),
    NameOf);

class Dropping : public ::testing::TestWithParam<Rule> {};

TEST_P(Dropping, TheGoodTextPassesAndTheBadFieldIsDroppedAlone) {
  const Rule& rule = GetParam();
  const RcanJudgement good = JudgeOf(rule.good);
  EXPECT_EQ(good.rejection(), nullptr);
  EXPECT_TRUE(good.dropped.empty());
  const RcanJudgement bad = JudgeOf(rule.bad);
  ASSERT_EQ(bad.rejection(), nullptr) << bad.rejection()->detail;
  ASSERT_EQ(bad.dropped.size(), 1U);
  EXPECT_EQ(bad.dropped[0].reason, rule.reason) << bad.dropped[0].detail;
  EXPECT_EQ(bad.dropped[0].field, rule.field);
  EXPECT_EQ(std::get<model::RcanState>(bad.verdict).clock_source, "ntp") << "the rest is kept";
}

/// With a member that must stay.
std::string Beside(const std::string& member) { return State(R"("clock_source":"ntp",)" + member); }
std::string BesideJoint(const std::string& member) {
  return Beside(R"("joints":[{"joint":"a","timestamp_us":1,)" + member + "}]");
}

INSTANTIATE_TEST_SUITE_P(
    Rules, Dropping,
    ::testing::Values(
        Rule{"seq from 1", Beside(R"("seq":1)"), Beside(R"("seq":0)"), RejectReason::kOutOfRange,
             "seq"},
        Rule{"seq whole", Beside(R"("seq":2.0)"), Beside(R"("seq":2.5)"),
             RejectReason::kTypeMismatch, "seq"},
        Rule{"uptime from 0", Beside(R"("uptime_ms":0)"), Beside(R"("uptime_ms":-1)"),
             RejectReason::kOutOfRange, "uptime_ms"},
        Rule{"uptime within 64 bits", Beside(R"("uptime_ms":1e18)"), Beside(R"("uptime_ms":1e19)"),
             RejectReason::kOutOfRange, "uptime_ms"},
        Rule{"volts from 0", Beside(R"("battery_v":0)"), Beside(R"("battery_v":-0.1)"),
             RejectReason::kOutOfRange, "battery_v"},
        Rule{"volts a number", Beside(R"("battery_v":12)"), Beside(R"("battery_v":"12")"),
             RejectReason::kTypeMismatch, "battery_v"},
        Rule{"null is no number", Beside(R"("battery_v":12)"), Beside(R"("battery_v":null)"),
             RejectReason::kTypeMismatch, "battery_v"},
        Rule{"percent to 100", Beside(R"("battery_pct":100)"), Beside(R"("battery_pct":101)"),
             RejectReason::kOutOfRange, "battery_pct"},
        Rule{"percent from 0", Beside(R"("battery_pct":0)"), Beside(R"("battery_pct":-1)"),
             RejectReason::kOutOfRange, "battery_pct"},
        Rule{"percent whole", Beside(R"("battery_pct":78.0)"), Beside(R"("battery_pct":78.5)"),
             RejectReason::kTypeMismatch, "battery_pct"},
        Rule{"position an object", Beside(R"("position":{"x":1,"y":2})"),
             Beside(R"("position":[1,2])"), RejectReason::kTypeMismatch, "position"},
        Rule{"position's x", Beside(R"("position":{"x":1,"y":2,"z":3})"),
             Beside(R"("position":{"y":2})"), RejectReason::kMissingField, "position.x"},
        Rule{"position's y", Beside(R"("position":{"x":1,"y":2})"),
             Beside(R"("position":{"x":1,"y":true})"), RejectReason::kTypeMismatch, "position.y"},
        Rule{"heading", Beside(R"("position":{"x":1,"y":2,"heading_rad":-7})"),
             Beside(R"("position":{"x":1,"y":2,"heading_rad":"n"})"), RejectReason::kTypeMismatch,
             "position.heading_rad"},
        Rule{"joints a list", Beside(R"("joints":[])"), Beside(R"("joints":{})"),
             RejectReason::kTypeMismatch, "joints"},
        Rule{"joints are objects", Beside(R"("joints":[])"), Beside(R"("joints":[7])"),
             RejectReason::kTypeMismatch, "joints[0]"},
        Rule{"joint named", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"timestamp_us":5}])"), RejectReason::kMissingField,
             "joints[0].joint"},
        Rule{"joint's name not empty", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"joint":"","timestamp_us":5}])"), RejectReason::kMissingField,
             "joints[0].joint"},
        Rule{"joint's name a string", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"joint":{},"timestamp_us":5}])"), RejectReason::kTypeMismatch,
             "joints[0].joint"},
        Rule{
            "joint's name's length",
            Beside("\"joints\":[{\"timestamp_us\":5,\"joint\":\"" + std::string(128, 'j') + "\"}]"),
            Beside("\"joints\":[{\"timestamp_us\":5,\"joint\":\"" + std::string(129, 'j') + "\"}]"),
            RejectReason::kTextTooLong, "joints[0].joint"},
        Rule{"joint's name without NUL", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"joint":"a\u0000","timestamp_us":5}])"),
             RejectReason::kTextNotUtf8, "joints[0].joint"},
        Rule{"joint's time there", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"joint":"a"}])"), RejectReason::kMissingField,
             "joints[0].timestamp_us"},
        Rule{"joint's time not below 0", BesideJoint(R"("effort_nm":1)"),
             Beside(R"("joints":[{"joint":"a","timestamp_us":-5}])"), RejectReason::kOutOfRange,
             "joints[0].timestamp_us"},
        Rule{"joint's position", BesideJoint(R"("position_rad":-1)"),
             BesideJoint(R"("position_rad":[])"), RejectReason::kTypeMismatch,
             "joints[0].position_rad"},
        Rule{"joint's velocity", BesideJoint(R"("velocity_rad_s":1.5)"),
             BesideJoint(R"("velocity_rad_s":{})"), RejectReason::kTypeMismatch,
             "joints[0].velocity_rad_s"},
        Rule{"prismatic position", BesideJoint(R"("position_m":0.25)"),
             BesideJoint(R"("position_m":false)"), RejectReason::kTypeMismatch,
             "joints[0].position_m"},
        Rule{"prismatic velocity", BesideJoint(R"("velocity_m_s":0.25)"),
             BesideJoint(R"("velocity_m_s":"")"), RejectReason::kTypeMismatch,
             "joints[0].velocity_m_s"},
        Rule{"effort", BesideJoint(R"("effort_nm":-3)"), BesideJoint(R"("effort_nm":null)"),
             RejectReason::kTypeMismatch, "joints[0].effort_nm"},
        Rule{"temperature", BesideJoint(R"("temperature_c":40)"),
             BesideJoint(R"("temperature_c":"40")"), RejectReason::kTypeMismatch,
             "joints[0].temperature_c"},
        Rule{"error flags whole", BesideJoint(R"("error_flags":18446744073709551615)"),
             BesideJoint(R"("error_flags":0.5)"), RejectReason::kTypeMismatch,
             "joints[0].error_flags"},
        Rule{"error flags from 0", BesideJoint(R"("error_flags":0)"),
             BesideJoint(R"("error_flags":-1)"), RejectReason::kOutOfRange,
             "joints[0].error_flags"}),
    NameOf);

TEST(RcanState, EveryFieldIsReadAndRenderedAgain) {
  const std::string text =
      R"({"ruri":"rcan://local.rcan/acme/arm/1","seq":9007199254740993,"uptime_ms":3600000,)"
      R"("battery_v":14.2,"battery_pct":78,"position":{"x":1.2,"y":-5E-1,"heading_rad":1.57},)"
      R"("joints":[{"joint":"lift","position_m":2.5E-1,"velocity_m_s":1E-2,"error_flags":)"
      R"(18446744073709551615,"timestamp_us":1741737600000000},{"joint":"pan","position_rad":)"
      R"(7.85E-1,"velocity_rad_s":2E-2,"effort_nm":4.1E-1,"temperature_c":38.5,)"
      R"("timestamp_us":9223372036854775807}],"clock_source":"ptp","timestamp_us":)"
      R"(1741737600000000})";
  const RcanJudgement first = JudgeOf(text);
  ASSERT_EQ(first.rejection(), nullptr);
  const auto& state = std::get<model::RcanState>(first.verdict);
  EXPECT_EQ(state.seq, 9007199254740993);
  EXPECT_EQ(state.joints[0].error_flags, 18446744073709551615U);
  EXPECT_EQ(state.joints[1].timestamp_us, 9223372036854775807);
  EXPECT_EQ(state.joints[1].position_rad, 0.785);
  EXPECT_EQ(state.position->heading_rad, 1.57);
  const std::string again = boost::json::serialize(json::Render(state, kRuri));
  const RcanJudgement second = JudgeOf(again);
  ASSERT_EQ(second.rejection(), nullptr);
  EXPECT_EQ(std::get<model::RcanState>(second.verdict), state);
}

TEST(RcanState, ControlCharactersAreReplacedAndCounted) {
  const RcanJudgement judgement = JudgeOf(State(
      R"("clock_source":"a\u0001\u0085\t","joints":[{"joint":"\u001b[1m","timestamp_us":1}])"));
  ASSERT_EQ(judgement.rejection(), nullptr);
  const auto& state = std::get<model::RcanState>(judgement.verdict);
  EXPECT_EQ(state.clock_source, "a\uFFFD\uFFFD\t");
  EXPECT_EQ(state.joints[0].joint, "\uFFFD[1m");
  EXPECT_EQ(judgement.control_characters, 3U);
}

TEST(RcanState, JointsThatBecomeTheSameAreTheSame) {
  const RcanJudgement judgement = JudgeOf(State(
      R"("joints":[{"joint":"\u0001","timestamp_us":1},{"joint":"\u0002","timestamp_us":1}])"));
  ASSERT_NE(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.rejection()->reason, RejectReason::kDuplicateKey);
  EXPECT_EQ(judgement.control_characters, 0U);
}

TEST(RcanState, TheRuriIsComparedAsItWasSent) {
  const std::string text = R"({"ruri":"rcan://local.rcan/acme/arm/\u0001","timestamp_us":1})";
  const RcanJudgement judgement =
      JudgeRcanState(text, "rcan://local.rcan/acme/arm/\uFFFD", kBytesMax);
  ASSERT_NE(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.rejection()->reason, RejectReason::kIdentityMismatch);
}

TEST(RcanState, ATextAtItsLimitComesBackThoughItGrew) {
  std::string name;
  for (std::size_t i = 0; i < kIdBytesMax; ++i) name += "\\u0001";
  const std::string text = State(R"("joints":[{"timestamp_us":1,"joint":")" + name + "\"}]");
  const RcanJudgement first = JudgeOf(text);
  ASSERT_EQ(first.rejection(), nullptr);
  ASSERT_TRUE(first.dropped.empty());
  const auto& state = std::get<model::RcanState>(first.verdict);
  EXPECT_EQ(state.joints[0].joint.size(), kIdBytesMax * kReplacementBytes);
  const std::string again = boost::json::serialize(json::Render(state, kRuri));
  const RcanJudgement second = JudgeRcanState(again, kRuri, kBytesMax, TextForm::kAsKept);
  ASSERT_EQ(second.rejection(), nullptr);
  EXPECT_EQ(std::get<model::RcanState>(second.verdict), state);
}

class DroppedJoints : public ::testing::TestWithParam<int> {};

TEST_P(DroppedJoints, AllAreCountedAndTheFirstAreTold) {
  const int invalid = GetParam();
  const int told_max = static_cast<int>(kDroppedFieldsListedMax);
  std::string list;
  for (int i = 0; i < invalid; ++i) list += R"({"joint":"j)" + std::to_string(i) + "\"},";
  const RcanJudgement judgement =
      JudgeOf(State("\"joints\":[" + list +
                    R"({"joint":"good","timestamp_us":1,"effort_nm":"x","position_m":2}])"));
  ASSERT_EQ(judgement.rejection(), nullptr);
  const int dropped = invalid + 1;
  EXPECT_EQ(judgement.dropped.size(), static_cast<std::size_t>(std::min(dropped, told_max)));
  std::size_t unlisted = 0;
  for (const model::UnlistedFields& fields : judgement.unlisted) unlisted += fields.fields;
  EXPECT_EQ(unlisted, static_cast<std::size_t>(std::max(0, dropped - told_max)));
  const auto& joints = std::get<model::RcanState>(judgement.verdict).joints;
  ASSERT_EQ(joints.size(), 1U);
  EXPECT_EQ(joints[0].position_m, 2);
  EXPECT_FALSE(joints[0].effort_nm.has_value());
}

INSTANTIATE_TEST_SUITE_P(Bound, DroppedJoints, ::testing::Values(14, 15, 16, 255));

TEST(RcanState, AJointAtFaultGoesAloneAndItsNumberBeyondADoubleRejects) {
  const RcanJudgement judgement =
      JudgeOf(State(R"("battery_v":5,"joints":[{"joint":"a","timestamp_us":1},{"joint":"b"},)"
                    R"({"joint":"c","timestamp_us":1,"effort_nm":"x"}])"));
  ASSERT_EQ(judgement.rejection(), nullptr);
  const auto& state = std::get<model::RcanState>(judgement.verdict);
  EXPECT_EQ(state.battery_v, 5);
  ASSERT_EQ(state.joints.size(), 2U);
  EXPECT_EQ(state.joints[1].joint, "c");
  ASSERT_EQ(judgement.dropped.size(), 2U);
  EXPECT_EQ(judgement.dropped[0].field, "joints[1].timestamp_us");
  EXPECT_EQ(judgement.dropped[1].field, "joints[2].effort_nm");
  const RcanJudgement beyond = JudgeOf(Joint(R"("effort_nm":1e400)"));
  ASSERT_NE(beyond.rejection(), nullptr);
  EXPECT_EQ(beyond.rejection()->field, "joints[0].effort_nm");
}

TEST(RcanState, UnknownFieldsAreIgnoredEverywhereAndTheLastOfADoubleKeyCounts) {
  const RcanJudgement judgement = JudgeOf(
      State(R"("com.example.motor_temp_c":42.1,"battery_v":1,"battery_v":2,"type":"STATUS",)"
            R"("position":{"x":1,"y":2,"frame":"map"},"joints":[{"joint":"a","timestamp_us":1,)"
            R"("com.example.x":[1e400]}])"));
  ASSERT_EQ(judgement.rejection(), nullptr);
  EXPECT_TRUE(judgement.dropped.empty());
  EXPECT_EQ(std::get<model::RcanState>(judgement.verdict).battery_v, 2);
}

TEST(RcanState, ASignOfLifeIsAnObjectOfThisRobot) {
  EXPECT_TRUE(JudgeOf(State("")).sign_of_life);
  EXPECT_TRUE(JudgeOf(R"({"ruri":"acme.arm.1"})").sign_of_life) << "whatever the rules say";
  EXPECT_FALSE(JudgeOf(R"({"ruri":"acme.arm.2","timestamp_us":1})").sign_of_life);
  EXPECT_FALSE(JudgeOf("{").sign_of_life);
  EXPECT_FALSE(JudgeOf("7").sign_of_life);
}

TEST(Ruri, IsNormalisedNoFurtherThanTheRulesSay) {
  EXPECT_EQ(NormalRuri("acme.arm.1"), "rcan://local.rcan/acme/arm/1");
  EXPECT_EQ(NormalRuri("acme.arm.1?sig=ab"), "rcan://local.rcan/acme/arm/1");
  EXPECT_EQ(NormalRuri("rcan://A/b?sig=x&y"), "rcan://A/b");
  for (const char* same : {"rcan://robot.local", "rcan://a.b.c", "acme.arm", "a.b.c.d", "a..c",
                           "http://a.b.c", "", ".."}) {
    EXPECT_EQ(NormalRuri(same), same);
  }
}

TEST(RcanState, HoldsAFewTimesItsText) {
  // As many joints as may be, each in as few bytes as may be.
  const std::string text = Joints(static_cast<int>(kRcanJointsMax));
  const RcanJudgement judgement = JudgeOf(text);
  const auto& state = std::get<model::RcanState>(judgement.verdict);
  ASSERT_EQ(state.joints.size(), kRcanJointsMax);
  EXPECT_LE(state.joints.capacity() * sizeof(model::RcanJoint), kTraversalFactor * text.size());
}

}  // namespace
}  // namespace uplink::schema
