// Joints in their three formats, what is a wanted value, and what slides.
#include <algorithm>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "schema/limits.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::RejectReason;
using model::cyberwave::Commanded;
using model::cyberwave::Joint;
using model::cyberwave::Joints;
using test::JudgeOn;
using test::Members;

Joints Update(const std::string& payload, const JudgeTerms& terms = {}) {
  return test::BodyOf<Joints>(JudgeOn("joint/update", payload, terms));
}

/// The joint of that name; one without name if there is none.
Joint Of(const Joints& joints, std::string_view name) {
  const auto found = std::find_if(joints.joints.begin(), joints.joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  return found == joints.joints.end() ? Joint() : *found;
}

RejectReason ReasonOf(const std::string& payload) {
  const Judgement judgement = JudgeOn("joint/update", payload);
  if (judgement.rejection() != nullptr) return judgement.rejection()->reason;
  ADD_FAILURE() << "it passes";
  return {};
}

TEST(CyberwaveJoints, ReadsASingleJoint) {
  const Joints joints =
      Update(R"({"type":"joint_state","joint_name":"elbow",)"
             R"("joint_state":{"position":0.25,"velocity":-1,"effort":1.5},"timestamp":1})");
  ASSERT_EQ(joints.joints.size(), 1U);
  EXPECT_EQ(joints.joints.front(),
            (Joint{.name = "elbow", .position = 0.25, .velocity = -1, .effort = 1.5}));
}

TEST(CyberwaveJoints, LeavesUnsaidChannelsOut) {
  EXPECT_EQ(Of(Update(R"({"joint_name":"a","joint_state":{"velocity":null,"effort":2}})"), "a"),
            (Joint{.name = "a", .effort = 2}));
  EXPECT_EQ(Of(Update(R"({"joint_name":"a","joint_state":{}})"), "a"), (Joint{.name = "a"}));
}

TEST(CyberwaveJoints, RejectsASingleJointWithoutAGoodName) {
  EXPECT_EQ(ReasonOf(R"({"joint_name":"","joint_state":{"position":1}})"),
            RejectReason::kMissingField);
  EXPECT_EQ(ReasonOf(R"({"joint_name":7,"joint_state":{"position":1}})"),
            RejectReason::kTypeMismatch);
  const auto named = [](std::size_t bytes) {
    return R"({"joint_name":")" + std::string(bytes, 'j') + R"(","joint_state":{"position":1}})";
  };
  EXPECT_EQ(Update(named(schema::kNameBytesMax)).joints.size(), 1U);
  EXPECT_EQ(ReasonOf(named(schema::kNameBytesMax + 1)), RejectReason::kTextTooLong);
}

TEST(CyberwaveJoints, ReadsMapsOfEachChannel) {
  const Joints joints = Update(
      R"({"positions":{"a":1,"b":2},"velocities":{"b":3,"c":4,"a":null},"efforts":{"d":5,"b":6}})");
  EXPECT_EQ(joints.joints.size(), 4U);
  EXPECT_EQ(Of(joints, "a"), (Joint{.name = "a", .position = 1}));
  EXPECT_EQ(Of(joints, "b"), (Joint{.name = "b", .position = 2, .velocity = 3, .effort = 6}));
  EXPECT_EQ(Of(joints, "c"), (Joint{.name = "c", .velocity = 4}));
  EXPECT_EQ(Of(joints, "d"), (Joint{.name = "d", .effort = 5}));
}

TEST(CyberwaveJoints, ReadsAJointWhosePositionIsNull) {
  const Joints joints = Update(R"({"positions":{"a":null},"velocities":{"a":2},"efforts":{}})");
  ASSERT_EQ(joints.joints.size(), 1U);
  EXPECT_EQ(joints.joints.front(), (Joint{.name = "a", .velocity = 2}));
}

TEST(CyberwaveJoints, DropsWhatIsWrongInAMapAndKeepsTheRest) {
  const Judgement judgement =
      JudgeOn("joint/update",
              R"({"positions":{"a":1,"b":true,"":2},"velocities":[],"efforts":{"b":1e400}})");
  EXPECT_EQ(test::BodyOf<Joints>(judgement).joints.size(), 1U);
  ASSERT_EQ(judgement.dropped.size(), 4U);
  EXPECT_EQ(judgement.dropped[0].field, "velocities");
  EXPECT_EQ(judgement.dropped[1].field, "positions.b");
  EXPECT_EQ(judgement.dropped[2].field, "efforts.b");
  EXPECT_EQ(judgement.dropped[2].reason, RejectReason::kNotFinite);
  EXPECT_EQ(judgement.dropped[3].reason, RejectReason::kMissingField);
}

TEST(CyberwaveJoints, ReadsFlatNumbers) {
  const Joints joints =
      Update(R"({"source_type":"edge","_1":0.5,"mode":3,"_2":-1,"on":true,"text":"7","o":{"x":1},)"
             R"("list":[1],"none":null,"session_id":"s"})");
  EXPECT_EQ(joints.joints.size(), 2U);
  EXPECT_EQ(Of(joints, "_1"), (Joint{.name = "_1", .position = 0.5}));
  EXPECT_EQ(Of(joints, "_2"), (Joint{.name = "_2", .position = -1}));
}

TEST(CyberwaveJoints, TakesNoTimeOrModeForAJoint) {
  const Joints joints =
      Update(R"({"timestamp":1,"ts":2,"ts_raw":3,"ts_norm":4,"ts_unix":5,"ts_us":6,"mode":7,)"
             R"("update_mode":8,"timestamps":9})");
  ASSERT_EQ(joints.joints.size(), 1U);
  EXPECT_EQ(joints.joints.front().name, "timestamps");
}

TEST(CyberwaveJoints, TakesTheFirstFormatThatMatches) {
  const std::string all = R"("joint_name":"a","positions":{"b":2},"c":3,"joint_state":)";
  EXPECT_EQ(Update("{" + all + R"({"position":1}})").joints.front().name, "a");
  EXPECT_EQ(Update("{" + all + "1}").joints.front().name, "b");
  EXPECT_EQ(Update(R"({"joint_state":{"position":1},"efforts":{"b":2},"c":3})").joints.front().name,
            "b");
  EXPECT_EQ(Update(R"({"joint_name":"a","positions":null,"c":3})").joints.front().name, "c");
}

TEST(CyberwaveJoints, ALaterDuplicateKeyCounts) {
  EXPECT_EQ(Of(Update(R"({"_1":1,"_1":2})"), "_1").position, 2);
  EXPECT_EQ(Of(Update(R"({"positions":{"a":1},"positions":{"a":3}})"), "a").position, 3);
}

TEST(CyberwaveJoints, CountsWantedValuesAndKeepsNone) {
  const Joints beside = Update(
      R"({"positions":{"a":1},"applied_position_targets":{"a":2,"b":3},"target_velocities":{"a":1}})");
  EXPECT_EQ(beside.joints.size(), 1U);
  EXPECT_EQ(beside.setpoints, 3U);
  const Joints alone = Update(R"({"target_positions":{"a":1,"b":null},"target_efforts":{"a":1},)"
                              R"("target_joint_state":{"position":1}})");
  EXPECT_TRUE(alone.joints.empty());
  EXPECT_EQ(alone.setpoints, 3U);
  EXPECT_TRUE(Update(R"({"target_positions":5})").joints.empty());
}

TEST(CyberwaveJoints, CountsAllOfACommand) {
  const Judgement judgement = JudgeOn(
      "joint/update", R"({"source_type":"tele","_1":0.5,"_2":1,"target_efforts":{"_1":1}})");
  EXPECT_EQ(judgement.message_class, MessageClass::kObserved);
  EXPECT_EQ(test::BodyOf<Commanded>(judgement).setpoints, 3U);
}

TEST(CyberwaveJoints, SlideIfTheyAreConfiguredTo) {
  const JudgeTerms terms = {.prismatic_joints = {"lift", "rail"}};
  const Joints joints = Update(R"({"lift":1,"lif":1,"lift2":1,"rail":1})", terms);
  EXPECT_TRUE(Of(joints, "lift").prismatic);
  EXPECT_TRUE(Of(joints, "rail").prismatic);
  EXPECT_FALSE(Of(joints, "lif").prismatic);
  EXPECT_FALSE(Of(joints, "lift2").prismatic);
  EXPECT_TRUE(Update(R"({"joint_name":"lift","joint_state":{}})", terms).joints.front().prismatic);
  EXPECT_TRUE(Update(R"({"efforts":{"lift":1}})", terms).joints.front().prismatic);
}

TEST(CyberwaveJoints, TakesAsManyAsAllowed) {
  EXPECT_EQ(Update("{" + Members(256, "j", "1") + R"(,"mode":1})").joints.size(), 256U);
  EXPECT_EQ(ReasonOf("{" + Members(257, "j", "1") + "}"), RejectReason::kTooManyItems);
  EXPECT_EQ(Update(R"({"positions":{)" + Members(256, "j", "1") + R"(},"efforts":{)" +
                   Members(256, "j", "1") + "}}")
                .joints.size(),
            256U);
  EXPECT_EQ(ReasonOf(R"({"positions":{)" + Members(256, "j", "1") + R"(},"efforts":{"other":1}})"),
            RejectReason::kTooManyItems);
  EXPECT_EQ(Update(R"({"positions":{"x":null,)" + Members(256, "j", "1") + "}}").joints.size(),
            256U);
  EXPECT_EQ(Update(R"({"target_efforts":{)" + Members(256, "j", "1") + "}}").setpoints, 256U);
  EXPECT_EQ(ReasonOf(R"({"target_efforts":{)" + Members(257, "j", "1") + "}}"),
            RejectReason::kTooManyItems);
}

TEST(CyberwaveJoints, ReadsJointStatesAsPositions) {
  const Judgement judgement =
      JudgeOn("joint_states", R"({"joint_states":{"elbow":0.5,"wrist":null,"x":"1"},"other":7})");
  const Joints joints = test::BodyOf<Joints>(judgement);
  ASSERT_EQ(joints.joints.size(), 1U);
  EXPECT_EQ(joints.joints.front(), (Joint{.name = "elbow", .position = 0.5}));
  ASSERT_EQ(judgement.dropped.size(), 1U);
  EXPECT_EQ(judgement.dropped.front().field, "joint_states.x");
  EXPECT_EQ(test::BodyOf<Joints>(
                JudgeOn("joint_states", R"({"joint_states":{)" + Members(256, "j", "1") + "}}"))
                .joints.size(),
            256U);
  EXPECT_NE(
      JudgeOn("joint_states", R"({"joint_states":{)" + Members(257, "j", "1") + "}}").rejection(),
      nullptr);
}

TEST(CyberwaveJoints, ShowsAForeignNameCutAndPrintable) {
  const std::string name = "\\u001b" + std::string(100, 'n');
  const Judgement judgement =
      JudgeOn("joint/update", R"({"positions":{"a":1,")" + name + R"(":"x"}})");
  ASSERT_EQ(judgement.dropped.size(), 1U);
  EXPECT_EQ(judgement.dropped.front().field.substr(0, 15), R"(positions.\x1bn)");
  EXPECT_LE(judgement.dropped.front().field.size(), std::string("positions.").size() + 64);
}

TEST(CyberwaveJoints, ReplacesControlCharactersInNames) {
  const Judgement judgement = JudgeOn("joint/update", R"({"a\u0001b":1})");
  EXPECT_EQ(test::BodyOf<Joints>(judgement).joints.front().name,
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(judgement.control_characters, 1U);
}

}  // namespace
}  // namespace uplink::cyberwave
