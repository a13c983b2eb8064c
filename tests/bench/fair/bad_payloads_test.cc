#include "tests/bench/fair/bad_payloads.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/judge.h"
#include "schema/rcan/judge.h"
#include "tests/support/records.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kMessageBytesMax = std::size_t{64} * 1024;
constexpr const char* kRuri = "rcan://bench.local/robots/bad";

schema::Judgement Judged(const std::string& payload) {
  schema::Judge judge{schema::JudgeLimits()};
  return judge.Payload(test::AsPayload(payload));
}

template <typename Body>
Body BodyOf(const std::string& payload) {
  const schema::Judgement judgement = Judged(payload);
  if (judgement.record() == nullptr) {
    ADD_FAILURE() << judgement.rejection()->field << ": " << judgement.rejection()->detail;
    return {};
  }
  return std::get<Body>(judgement.record()->body());
}

TEST(BadPayloadsTest, ALargeShapeIsGoodAndExactlyAsLargeAsOneMayBe) {
  for (std::size_t number : {std::size_t{0}, std::size_t{31}}) {
    const std::string payload = LargeShape(number);
    EXPECT_EQ(payload.size(), schema::JudgeLimits().payload_bytes_max);
    EXPECT_EQ(BodyOf<model::ShapeOp>(payload).id(), "large-" + std::to_string(number));
  }
}

TEST(BadPayloadsTest, ALongTextIsGood) {
  EXPECT_EQ(BodyOf<model::Message>(LongText()).message, std::string(kLongTextBytes, 't'));
}

TEST(BadPayloadsTest, ControlCharactersAreGoodContentOfTextsAndSettings) {
  // A server may keep them, or replace each by another character: the payload is taken.
  EXPECT_EQ(Judged(ControlText()).rejection(), nullptr);
  const std::string settings = ControlSettings();
  EXPECT_EQ(Judged(settings).rejection(), nullptr);
  EXPECT_GT(settings.size(), kLargeShapeBytes * 9 / 10);
  for (const std::string& payload : {ControlText(), settings}) {
    EXPECT_GE(std::ranges::count(payload, '\x01'), static_cast<std::ptrdiff_t>(kLongTextBytes));
  }
}

TEST(BadPayloadsTest, WhatIsMalformedIsSoInEveryWay) {
  std::set<std::string> details;
  for (std::size_t number = 0; number < kWaysToBeMalformed; ++number) {
    const schema::Judgement judgement = Judged(Malformed(number));
    ASSERT_NE(judgement.rejection(), nullptr) << number;
    EXPECT_EQ(judgement.rejection()->reason, model::RejectReason::kMalformed) << number;
    details.insert(judgement.rejection()->detail);
  }
  EXPECT_EQ(details.size(), kWaysToBeMalformed);
}

TEST(BadPayloadsTest, ExtrasAreRejectedWithNoReadingThatIsGood) {
  const schema::Judgement judgement = Judged(FaultyExtras(0));
  ASSERT_NE(judgement.rejection(), nullptr);
  EXPECT_EQ(judgement.rejection()->reason, model::RejectReason::kNotFinite);
}

TEST(BadPayloadsTest, ExtrasWithOneGoodReadingLoseTheOthers) {
  const std::string payload = FaultyExtras(1);
  EXPECT_LE(payload.size(), kMessageBytesMax);
  const schema::Judgement judgement = Judged(payload);
  ASSERT_NE(judgement.record(), nullptr);
  EXPECT_EQ(std::get<model::TelemetryExtras>(judgement.record()->body()).kv.size(), 1U);
  EXPECT_FALSE(judgement.record()->dropped().empty());
}

TEST(BadPayloadsTest, AStateIsGoodAndItsJointsAreNewInEachGeneration) {
  std::set<std::string> names;
  for (std::uint64_t generation : {1U, 2U, 1'000'000U}) {
    const std::string text = RenamedJoints(
        kRuri, 1'763'683'200'000'000 + static_cast<std::int64_t>(generation), generation);
    const schema::RcanJudgement judgement = schema::JudgeRcanState(text, kRuri, kMessageBytesMax);
    ASSERT_EQ(judgement.rejection(), nullptr) << judgement.rejection()->detail;
    EXPECT_TRUE(judgement.dropped.empty());
    for (const auto& joint : std::get<model::RcanState>(judgement.verdict).joints) {
      names.insert(joint.joint);
    }
  }
  EXPECT_EQ(names.size(), 3 * kRenamedJoints);
}

TEST(BadPayloadsTest, EventsOfTheOthersAreGood) {
  EXPECT_EQ(Judged(GoodEvent(1)).rejection(), nullptr);
}

}  // namespace
}  // namespace uplink::bench
