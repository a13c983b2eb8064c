// RCAN's Robot States in a stream: their order, their joints, what becomes of them.
#include <string>

#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::string_view kHead = R"({"ruri":"rcan://bench/1","timestamp_us":)";

std::string State(std::int64_t timestamp_us, const std::string& members = "") {
  return std::string(kHead) + std::to_string(timestamp_us) +
         (members.empty() ? "" : "," + members) + "}";
}
std::string Joint(const std::string& name, std::int64_t timestamp_us, double position) {
  return R"({"joint":")" + name + R"(","timestamp_us":)" + std::to_string(timestamp_us) +
         R"(,"position_rad":)" + std::to_string(position) + "}";
}
std::string Joints(const std::string& first, const std::string& second) {
  return "\"joints\":[" + first + "," + second + "]";
}

class RcanTest : public SessionTest {
 protected:
  RcanTest() : stream_(&server().Connect(SessionOf(1))) { static_cast<void>(stream_->TakeLines()); }

  void Send(std::initializer_list<std::string> states) {
    v1::RelayRequest frame;
    for (const std::string& state : states) {
      v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
      uplink.set_seq(++seq_);
      uplink.set_rcan_robot_state(state);
    }
    stream_->Send(frame);
  }
  void Reconnect() {
    stream_->Break();
    stream_ = &server().Connect(SessionOf(1), seq_, seq_);
    static_cast<void>(stream_->TakeLines());
  }
  [[nodiscard]] model::RcanState Latest() {
    const auto parts = server().robot().state.Snapshot(robot::RobotState::Parts::kAll).parts;
    return parts.rcan.value_or(model::RcanState{});
  }

  BenchStream* stream_;
  model::Seq seq_ = 0;
};

TEST_F(RcanTest, IsAppliedAtOnceAndASignOfLife) {
  Send({State(1000, R"("battery_v":12.5)")});
  EXPECT_EQ(Latest().battery_v, 12.5);
  EXPECT_EQ(server().counts().applied, 1U);
  EXPECT_EQ(server().counts().rcan_states, 1U);
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline);
}

class RcanWithoutLife : public RcanTest {
 protected:
  RcanWithoutLife() {
    limits_.session.rcan_counts_as_life = false;
    Start();
    stream_ = &server().Connect(SessionOf(2));
  }
};

TEST_F(RcanWithoutLife, ItIsNoneWhereTheSettingSaysSo) {
  Send({State(1000)});
  EXPECT_EQ(server().counts().applied, 1U);
  EXPECT_NE(server().robot().state.presence(), robot::Presence::kOnline);
}

TEST_F(RcanTest, AnOlderStateIsRejectedAndAnEqualOneSuperseded) {
  Send({State(1000, R"("battery_v":1)")});
  Send({State(1000, R"("battery_v":2)")});
  EXPECT_EQ(Latest().battery_v, 1) << "the same sample again";
  EXPECT_EQ(server().counts().superseded, 1U);
  Send({State(999, R"("battery_v":3)")});
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("reject 3 not_monotonic timestamp_us"));
  EXPECT_EQ(Latest().battery_v, 1);
  Send({State(1001, R"("battery_v":4)")});
  EXPECT_EQ(Latest().battery_v, 4);
  EXPECT_EQ(server().counts().applied, 2U);
}

TEST_F(RcanTest, OrderBeginsAnewWithEachHello) {
  Send({State(1000, R"("seq":9,)" + Joints(Joint("a", 50, 1), Joint("b", 50, 1)))});
  Reconnect();
  Send({State(10, R"("seq":1,)" + Joints(Joint("a", 5, 2), Joint("b", 5, 2)))});
  EXPECT_THAT(stream_->TakeLines(), IsEmpty());
  EXPECT_EQ(Latest().timestamp_us, 10);
  EXPECT_EQ(Latest().joints[0].position_rad, 2);
  EXPECT_EQ(Latest().seq_missing, 0U);
}

TEST_F(RcanTest, AJointThatIsNotNewerKeepsItsHeldSample) {
  Send({State(1000, Joints(Joint("a", 50, 1), Joint("b", 50, 1)))});
  Send({State(1001, Joints(Joint("a", 50, 2), Joint("b", 51, 2)) + R"(,"battery_v":7)")});
  EXPECT_EQ(Latest().joints[0].position_rad, 1);
  EXPECT_EQ(Latest().joints[1].position_rad, 2);
  EXPECT_EQ(Latest().battery_v, 7) << "the joint affects nothing else";
  Send({State(1002, Joints(Joint("b", 40, 3), Joint("c", 1, 3)))});
  EXPECT_EQ(Latest().joints[0].position_rad, 2);
  EXPECT_EQ(Latest().joints[0].timestamp_us, 51);
  Send({State(1003, Joints(Joint("a", 50, 9), Joint("c", 2, 4)))});
  EXPECT_EQ(Latest().joints[0].position_rad, 1) << "held while a state went without it";
}

TEST_F(RcanTest, GapsOfSeqAreCountedAndBlockNothing) {
  Send({State(1, R"("seq":5)"), State(2, R"("seq":6)")});
  EXPECT_EQ(Latest().seq_missing, 0U) << "nothing is known before the first";
  Send({State(3, R"("seq":10)")});
  EXPECT_EQ(Latest().seq_missing, 3U);
  Send({State(4), State(5, R"("seq":2)")});
  EXPECT_EQ(Latest().seq_missing, 3U) << "it began anew";
  Send({State(6, R"("seq":4)")});
  EXPECT_EQ(Latest().seq_missing, 4U);
  EXPECT_EQ(server().counts().rcan_missing, 4U);
  EXPECT_EQ(server().counts().rejected, 0U);
}

TEST_F(RcanTest, NumbersThatCameAreNotMissingWhateverBecameOfTheirStates) {
  Send({State(100, R"("seq":1)"), State(100, R"("seq":2)"), State(50, R"("seq":3)")});
  Send({State(200, R"("seq":4)")});
  EXPECT_EQ(Latest().seq_missing, 0U);
  EXPECT_EQ(server().counts().rcan_missing, 0U);
  // The sixth overtakes the fifth, which then comes too late.
  Send({State(300, R"("seq":6)"), State(250, R"("seq":5)"), State(400, R"("seq":7)")});
  EXPECT_EQ(Latest().seq_missing, 1U) << "what was counted once is not counted again";
}

TEST_F(RcanTest, TheLastOfAFrameWinsAndTheOthersAreSuperseded) {
  Send({State(1, R"("battery_v":1)"), State(2, R"("battery_v":2)"), State(3, R"("battery_v":3)")});
  EXPECT_EQ(Latest().battery_v, 3);
  EXPECT_EQ(server().counts().superseded, 2U);
  EXPECT_EQ(server().counts().applied, 1U);
  EXPECT_EQ(server().counts().rcan_states, 3U);
}

TEST_F(RcanTest, AFieldAtFaultIsDroppedWithANotice) {
  Send({State(1, R"("battery_pct":101,"battery_v":5)")});
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("notice 1 out_of_range battery_pct"));
  EXPECT_EQ(Latest().battery_v, 5);
  EXPECT_FALSE(Latest().battery_pct.has_value());
}

TEST_F(RcanTest, ControlCharactersAreReplacedAndCounted) {
  Send({State(1, R"("clock_source":"n\u0001tp")")});
  EXPECT_EQ(Latest().clock_source, "n\uFFFDtp");
  EXPECT_EQ(server().page().odd.control_characters, 1U);
}

TEST_F(RcanTest, EveryDroppedFieldIsCountedThoughNotEveryOneIsTold) {
  std::string joints = R"("joints":[)";
  for (int i = 0; i < 99; ++i) joints += R"({"joint":""},)";
  Send({State(1, joints + Joint("good", 1, 2) + "]")});
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("notice 1 missing_field joints[0].joint"));
  ASSERT_EQ(Latest().joints.size(), 1U);
  EXPECT_EQ(server().robot().state.Snapshot(robot::RobotState::Parts::kNone).fields_dropped, 99);
  EXPECT_EQ(server().page().dropped[metrics::kRcanKind]
                                   [static_cast<std::size_t>(model::RejectReason::kMissingField)],
            99U);
}

TEST_F(RcanTest, WhatIsRejectedLiesInQuarantine) {
  Send({R"({"ruri":"rcan://bench/2","timestamp_us":1})", "{"});
  EXPECT_THAT(stream_->TakeLines(),
              ElementsAre("reject 1 identity_mismatch ruri", "reject 2 malformed "));
  server().Commit();
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("ack 2 judged 2"));
  EXPECT_EQ(server().counts().rejected, 2U);
  EXPECT_NE(server().robot().state.presence(), robot::Presence::kOnline);
}

TEST_F(RcanTest, ItStandsBesideOtherMessagesOfAFrame) {
  v1::RelayRequest frame = BatchFrame({{1, Motion(47)}, {2, ""}, {3, Fault()}});
  frame.mutable_batch()->mutable_uplinks(1)->set_rcan_robot_state(State(1, R"("battery_v":5)"));
  stream_->Send(frame);
  server().Commit();
  EXPECT_THAT(stream_->TakeLines(), ElementsAre("ack 3 judged 3"));
  EXPECT_EQ(Latest().battery_v, 5);
  EXPECT_EQ(server().counts().applied, 2U);
  EXPECT_EQ(server().counts().stored, 1U);
}

}  // namespace
}  // namespace uplink::session
