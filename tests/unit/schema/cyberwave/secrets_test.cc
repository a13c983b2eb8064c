// What may hold secrets leaves none in what is told or kept of it.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using test::JudgeOn;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::string_view kSecret = "s3cret";
const std::vector<std::string> kSecretTails = {"command",       "navigate/command", "webrtc-offer",
                                               "webrtc-answer", "webrtc-candidate", "depth",
                                               "pointcloud"};
const std::vector<std::string> kOpenTails = {
    "position",       "rotation",  "scale",           "joint/update",   "metrics",
    "edge_health",    "telemetry", "navigate/status", "driverlog",      "event",
    "mission/status", "gps",       "joint_states",    "battery/status", "environment/added",
    "workflow-run",   "ping"};

std::string Under(const std::string& id, const std::string& tail) {
  return "cyberwave/twin/" + id + "/" + tail;
}

void ExpectNothingTold(const model::Rejection& told) {
  EXPECT_THAT(told.field, Not(HasSubstr(kSecret)));
  EXPECT_THAT(told.detail, Not(HasSubstr(kSecret)));
  EXPECT_FALSE(told.detail.empty());
}

TEST(CyberwaveSecrets, TheTopicSaysWhetherThePayloadMayBeKept) {
  EXPECT_EQ(kSecretTails.size() + kOpenTails.size(), TopicRows().size());
  for (const std::string payload : {"{}", "broken", R"({"source_type":"edge"})", ""}) {
    for (const std::string& tail : kSecretTails) {
      EXPECT_FALSE(JudgeOn(tail, payload).may_be_kept) << tail << " " << payload;
    }
    for (const std::string& tail : kOpenTails) {
      EXPECT_TRUE(JudgeOn(tail, payload).may_be_kept) << tail << " " << payload;
    }
  }
  EXPECT_FALSE(JudgeMessage("cyberwave/other", "{}", {}).may_be_kept);
}

TEST(CyberwaveSecrets, AnIdThatIsNotGoodChangesNothingOfThat) {
  for (const std::string& tail : kSecretTails) {
    const std::string topic = Under("s3cret", tail);
    const Judgement judgement = JudgeMessage(topic, R"({"sdp":"s3cret"})", {});
    ASSERT_NE(judgement.rejection(), nullptr) << topic;
    EXPECT_FALSE(judgement.may_be_kept) << topic;
    ExpectNothingTold(*judgement.rejection());
    EXPECT_EQ(KeptTopic(topic, judgement.topic), Under("?", tail));
  }
  EXPECT_TRUE(JudgeMessage(Under("x", "position"), "{}", {}).may_be_kept);
}

TEST(CyberwaveSecrets, NoRejectionOfACommandQuotesIt) {
  for (const std::string& payload : std::vector<std::string>{
           "s3cret", R"("s3cret")", R"({"s3cret":)", "{\"command\":\"s3cret\xFF\"}",
           R"({"s3cret":"\ud83d"})", R"({"command":"s3cret"}s3cret)",
           R"({"s3cret":)" + std::string(40, '[') + std::string(40, ']') + "}",
           "{\"command\":\"s3cret" + std::string(kMessageBytesMax, 'x') + "\"}"}) {
    const Judgement judgement = JudgeOn("command", payload);
    ASSERT_NE(judgement.rejection(), nullptr) << payload.substr(0, 80);
    ExpectNothingTold(*judgement.rejection());
  }
}

TEST(CyberwaveSecrets, NoDroppedFieldOfACommandIsQuoted) {
  for (const std::string name : {"command", "status", "action_id", "session_id", "source_type"}) {
    const Judgement judgement = JudgeOn("command", "{\"" + name + R"(":"s3cret\u0000"})");
    ASSERT_EQ(judgement.dropped.size(), 1U) << name;
    ExpectNothingTold(judgement.dropped.front());
    EXPECT_EQ(judgement.dropped.front().field, name);
    EXPECT_EQ(judgement.dropped.front().reason, model::RejectReason::kTextNotUtf8);
  }
}

TEST(CyberwaveSecrets, WhatIsACommandByItsOwnWordsIsNoOther) {
  const Judgement some =
      JudgeOn("joint/update",
              R"({"source_type":"tele","positions":{"s3cret\u0000":1,"s3cret":"1","a":1}})");
  EXPECT_EQ(some.message_class, MessageClass::kObserved);
  EXPECT_FALSE(some.may_be_kept);
  ASSERT_EQ(some.dropped.size(), 2U);
  for (const model::DroppedField& field : some.dropped) {
    ExpectNothingTold(field);
    EXPECT_EQ(field.field, "positions.*");
  }
  const Judgement none =
      JudgeOn("joint/update", R"({"source_type":"edit","positions":{"s3cret":""}})");
  ASSERT_NE(none.rejection(), nullptr);
  EXPECT_FALSE(none.may_be_kept);
  ExpectNothingTold(*none.rejection());
}

TEST(CyberwaveSecrets, WhatWasReadPastIsNoOther) {
  for (const std::string& tail : kSecretTails) {
    EXPECT_FALSE(JudgeUnread(test::TopicOf(tail), kMessageBytesMax + 1, {}).may_be_kept) << tail;
  }
  EXPECT_TRUE(JudgeUnread(test::TopicOf("event"), kMessageBytesMax + 1, {}).may_be_kept);
}

TEST(CyberwaveSecrets, AKeptTopicIsTheOneThatWasPublished) {
  const JudgeTerms terms = {.prefixes = {"", "site/a/"}, .prismatic_joints = {}};
  for (const std::string& tail : kSecretTails) {
    const std::string topic = "site/a/" + test::TopicOf(tail);
    EXPECT_EQ(KeptTopic(topic, JudgeMessage(topic, "{}", terms).topic), topic);
    const std::string bad = "site/a/" + Under("", tail);
    EXPECT_EQ(KeptTopic(bad, JudgeMessage(bad, "{}", terms).topic), "site/a/" + Under("?", tail));
  }
  const std::string open = Under("no-uuid", "position");
  EXPECT_EQ(KeptTopic(open, JudgeMessage(open, "{}", terms).topic), open);
  const std::string other = Under("s3cret", "s3cret");
  EXPECT_EQ(KeptTopic(other, JudgeMessage(other, "{}", terms).topic), "other");
}

}  // namespace
}  // namespace uplink::cyberwave
