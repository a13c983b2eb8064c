#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/judge.h"
#include "tests/unit/tools/fleet/compare/twin_mirror.h"
#include "tools/uplink-fleet/compare/compare_twin_live.h"
#include "tools/uplink-fleet/compare/compare_twin_rows.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {
namespace {

using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;

const TwinOptions kTwin{.seed = 7, .index = 1, .run = "run1", .prefix = ""};

std::vector<std::string> Lines(const TwinOptions& options, int messages) {
  TwinScript twin(options);
  std::vector<std::string> said;
  std::int64_t now_us = kTwinStartUs;
  for (int i = 0; i < messages; ++i) {
    const Publication each = twin.Next(now_us += 50'000);
    said.push_back(each.topic + " " + each.payload);
  }
  return said;
}

TEST(TwinScript, TheSameSeedSaysTheSame) {
  EXPECT_EQ(Lines(kTwin, 500), Lines(kTwin, 500));
  TwinOptions other = kTwin;
  other.seed = 8;
  EXPECT_NE(Lines(kTwin, 500), Lines(other, 500));
  other = kTwin;
  other.index = 2;
  EXPECT_NE(Lines(kTwin, 500), Lines(other, 500));
}

/// The topic's end, below the twin's id if it has one.
std::string TailOf(const std::string& topic, const TwinIds& ids) {
  const std::size_t at = topic.find(ids.twin);
  return at == std::string::npos ? topic.substr(0, topic.find('/', sizeof("cyberwave/")))
                                 : topic.substr(at + ids.twin.size() + 1);
}

TEST(TwinScript, EachTopicAndEachReasonComes) {
  const TwinMirror mirror(kTwin);
  std::set<std::string> tails;
  for (const Publication& each : mirror.published) {
    tails.insert(TailOf(each.topic, mirror.twin.ids()));
  }
  EXPECT_THAT(
      tails, IsSupersetOf({"position", "rotation", "scale", "gps", "update", "joint_states",
                           "metrics", "edge_health", "telemetry", "event", "driverlog",
                           "navigate/status", "mission/status", "battery/status", "command",
                           "webrtc-candidate", "cyberwave/environment", "cyberwave/workflow-run"}));
  std::set<model::RejectReason> reasons;
  for (const auto& [number, wrong] : mirror.twin.account().wrongs()) reasons.insert(wrong.reason);
  using enum model::RejectReason;
  EXPECT_THAT(reasons, IsSupersetOf({kMalformed, kTextNotUtf8, kTypeMismatch, kPayloadTooLarge,
                                     kTooManyItems, kTextTooLong, kMissingField, kIdentityMismatch,
                                     kNotFinite, kOutOfRange}));
}

TEST(TwinScript, WhatIsRightIsTakenWholeAndWhatIsWrongIsRejectedForItsReason) {
  const TwinMirror mirror(kTwin);
  EXPECT_EQ(mirror.dropped, 0U);
  for (const Publication& each : mirror.published) {
    const cyberwave::Judgement judgement =
        cyberwave::JudgeMessage(each.topic, each.payload, cyberwave::JudgeTerms());
    const auto& wrongs = mirror.twin.account().wrongs();
    const auto wrong = wrongs.find(each.number);
    const model::Rejection* rejection = judgement.rejection();
    ASSERT_EQ(rejection != nullptr, wrong != wrongs.end()) << each.topic << " " << each.payload;
    if (rejection == nullptr) continue;
    EXPECT_EQ(rejection->reason, wrong->second.reason) << each.topic << " " << each.payload;
  }
}

TEST(TwinScript, ManyTwinsAgreeWithAServerThatIsRight) {
  for (std::size_t index = 0; index < 8; ++index) {
    TwinMirror mirror({.seed = 11, .index = index, .run = "r", .prefix = "site 1/"}, 1500);
    Findings findings;
    CompareTwinLive(mirror.twin, mirror.look, findings);
    CompareTwinRows(mirror.twin, mirror.stored, mirror.nobody, findings);
    for (const Difference& each : findings.differences()) {
      ADD_FAILURE() << "twin " << index << ": " << TextOf(each.thing).name << " | " << each.expected
                    << " | " << each.found;
    }
  }
}

TEST(TwinScript, WhatIsStoredIsPublishedAtQos1) {
  const TwinMirror mirror(kTwin, 2000);
  for (const Publication& each : mirror.published) {
    if (mirror.twin.account().rows().contains(each.number)) {
      EXPECT_EQ(each.qos, Qos::k1) << each.topic;
      EXPECT_EQ(MarkIn(kTwin, each.payload), each.number);
    }
  }
}

TEST(TwinScript, PrefixesAreInTopicsAndNames) {
  TwinOptions options = kTwin;
  options.prefix = "a/b ";
  const TwinScript twin(options);
  EXPECT_TRUE(twin.ids().ruri.starts_with("rcan://local.rcan/cyberwave/twin.a%2Fb%20/"));
  EXPECT_TRUE(twin.ids().sim_ruri.starts_with("rcan://local.rcan/cyberwave/sim.a%2Fb%20/"));
  EXPECT_TRUE(Lines(options, 1).front().starts_with("a/b cyberwave/"));
}

TEST(TwinMark, IsFoundForItsTwinAndRunAlone) {
  const std::string text = "x" + MarkOf(kTwin, 17) + "y";
  EXPECT_EQ(MarkIn(kTwin, text), 17U);
  TwinOptions other = kTwin;
  other.index = 11;
  EXPECT_EQ(MarkIn(other, text), std::nullopt);
  other = kTwin;
  other.run = "run2";
  EXPECT_EQ(MarkIn(other, text), std::nullopt);
  EXPECT_EQ(MarkIn(kTwin, "~run1-1-17"), std::nullopt) << "cut";
}

TEST(TwinAccount, KnowsHowSureEachPublicationIs) {
  TwinAccount account;
  for (std::uint64_t number = 1; number <= 4; ++number) account.Published(number);
  account.Acked(1);
  account.Broke();
  account.Acked(2);
  account.Refused(3);
  EXPECT_EQ(account.DeliveryOf(1), Delivery::kOnce);
  EXPECT_EQ(account.DeliveryOf(2), Delivery::kOnceOrMore);
  EXPECT_EQ(account.DeliveryOf(3), Delivery::kUnknown);
  EXPECT_EQ(account.DeliveryOf(4), Delivery::kUnknown);
  EXPECT_EQ(account.waiting(), 1U);
  EXPECT_EQ(account.acked(), 2U);
  EXPECT_EQ(account.refused(), 1U);
}

}  // namespace
}  // namespace uplink::synthetic
