#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

/// Bytes that no encoder makes: judgement must answer each with a verdict, whatever they hold.
namespace uplink::test {
namespace {

using model::RejectReason;

void PutWord32(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  }
}

void ExpectMalformed(const schema::Judgement& judgement) {
  ExpectRejected(judgement, RejectReason::kMalformed, "");
  EXPECT_FALSE(judgement.sign_of_life);
}

TEST(MalformedTest, RejectsNoBytesAtAll) { ExpectMalformed(JudgeBytes("")); }

TEST(MalformedTest, RejectsEveryTruncation) {
  schema::Judge judge{schema::JudgeLimits()};
  for (const model::Body& body : SampleBodies()) {
    const std::string whole = schema::Encode(body);
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
      SCOPED_TRACE(bytes);
      ExpectMalformed(judge.Payload(AsPayload(std::string_view(whole).substr(0, bytes))));
    }
  }
}

TEST(MalformedTest, RejectsTruncationsWhoseSegmentTableAgrees) {
  schema::Judge judge{schema::JudgeLimits()};
  for (const model::Body& body : SampleBodies()) {
    const std::string whole = schema::Encode(body);
    // Three words are the header, the root pointer and the root's data.
    for (std::size_t bytes = 24; bytes < whole.size(); bytes += 8) {
      std::string cut = whole.substr(0, bytes);
      PutWord32(cut, 4, static_cast<std::uint32_t>(bytes / 8 - 1));
      ExpectMalformed(judge.Payload(AsPayload(cut)));
    }
  }
}

TEST(MalformedTest, RejectsBytesAfterTheMessage) {
  const std::string whole = schema::Encode(SampleMotion());
  for (std::size_t more = 1; more <= 17; ++more) {
    ExpectMalformed(JudgeBytes(whole + std::string(more, '\0')));
  }
}

TEST(MalformedTest, RejectsSegmentTablesThatLie) {
  const std::string whole = schema::Encode(SampleMotion());
  for (const std::uint32_t last_segment : {1U, 2U, 511U, 512U, 0x7FFF'FFFFU, 0xFFFF'FFFFU}) {
    std::string bytes = whole;
    PutWord32(bytes, 0, last_segment);
    ExpectMalformed(JudgeBytes(bytes));
  }
  for (const std::uint32_t words : {0U, 1U, 0x7FFF'FFFFU, 0xFFFF'FFFFU}) {
    std::string bytes = whole;
    PutWord32(bytes, 4, words);
    ExpectMalformed(JudgeBytes(bytes));
  }
}

/// `whole`, one segment, with empty segments behind it.
std::string WithSegments(const std::string& whole, std::uint32_t segments) {
  std::string bytes(8 * (segments / 2 + 1), '\0');
  PutWord32(bytes, 0, segments - 1);
  PutWord32(bytes, 4, static_cast<std::uint32_t>(whole.size() / 8 - 1));
  return bytes + whole.substr(8);
}

TEST(MalformedTest, TakesSegmentTablesUpToTheBound) {
  const std::string whole = schema::Encode(SampleMotion());
  ASSERT_EQ(WithSegments(whole, 1), whole);
  for (const std::uint32_t segments : {2U, 3U, 512U}) {
    ExpectGood(JudgeBytes(WithSegments(whole, segments)));
  }
  ExpectMalformed(JudgeBytes(WithSegments(whole, 513)));
}

TEST(MalformedTest, AnswersEveryFlippedBit) {
  schema::Judge judge{schema::JudgeLimits()};
  std::size_t rejected = 0;
  for (const model::Body& body : SampleBodies()) {
    const std::string whole = schema::Encode(body);
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      std::string bytes = whole;
      bytes[bit / 8] = static_cast<char>(static_cast<unsigned char>(bytes[bit / 8]) ^
                                         static_cast<unsigned char>(1U << (bit % 8)));
      const schema::Judgement judgement = judge.Payload(AsPayload(bytes));
      if (judgement.rejection() != nullptr) {
        ++rejected;
        ExpectReadable(*judgement.rejection());
      } else {
        for (const auto& field : judgement.record()->dropped()) ExpectReadable(field);
      }
    }
  }
  EXPECT_GT(rejected, 1000U);
}

TEST(MalformedTest, AnswersWordsOfNoiseInPlaceOfEachWord) {
  schema::Judge judge{schema::JudgeLimits()};
  std::uint64_t noise = 88172645463325252ULL;  // xorshift64, the same at every run
  for (const model::Body& body : SampleBodies()) {
    const std::string whole = schema::Encode(body);
    for (std::size_t word = 1; word < whole.size() / 8; ++word) {
      for (int round = 0; round < 16; ++round) {
        noise ^= noise << 13U;
        noise ^= noise >> 7U;
        noise ^= noise << 17U;
        std::string bytes = whole;
        PutWord32(bytes, 8 * word, static_cast<std::uint32_t>(noise));
        PutWord32(bytes, 8 * word + 4, static_cast<std::uint32_t>(noise >> 32U));
        const schema::Judgement judgement = judge.Payload(AsPayload(bytes));
        EXPECT_NE(judgement.record() == nullptr, judgement.rejection() == nullptr);
      }
    }
  }
}

TEST(SizeTest, DependsOnTheVariant) {
  // The text is far over its own limit, so that size alone decides the first answer.
  const auto of_text = [](std::size_t bytes) {
    model::Message message = SampleMessage();
    message.message = std::string(bytes, 'x');
    return schema::Encode(message);
  };
  constexpr std::size_t kMessageMax = std::size_t{64} * 1024;
  std::size_t text_at_limit = kMessageMax;
  while (of_text(text_at_limit).size() > kMessageMax) --text_at_limit;
  const std::string at_limit = of_text(text_at_limit);
  ASSERT_EQ(at_limit.size(), kMessageMax);
  ExpectRejected(JudgeBytes(at_limit), RejectReason::kTextTooLong, "message");
  ExpectRejected(JudgeBytes(of_text(text_at_limit + 1)), RejectReason::kPayloadTooLarge, "");
  ExpectRejected(JudgeBytes(of_text(100), {.message_bytes_max = 64}),
                 RejectReason::kPayloadTooLarge, "");
}

TEST(SizeTest, IsLargerForShapes) {
  model::ReportedShape shape = SampleShape();
  shape.data = model::MultiPoint{model::Positions(8000, {.lon = 1, .lat = 2})};
  const std::string payload = schema::Encode(model::ShapeOp{shape});
  ASSERT_GT(payload.size(), std::size_t{64} * 1024);
  ExpectGood(JudgeBytes(payload));
  ExpectGood(JudgeBytes(payload, {.payload_bytes_max = payload.size()}));
  ExpectRejected(JudgeBytes(payload, {.payload_bytes_max = payload.size() - 8}),
                 RejectReason::kPayloadTooLarge, "");
}

TEST(SizeTest, OfAStatusStillTellsThatTheRobotLives) {
  model::StatusTelemetry status = SampleStatus();
  status.status = std::string(70'000, 'x');
  const schema::Judgement judgement = JudgeBody(status);
  ExpectRejected(judgement, RejectReason::kPayloadTooLarge, "");
  EXPECT_TRUE(judgement.sign_of_life);
}

TEST(JudgeTest, ForgetsOnePayloadBeforeTheNext) {
  schema::Judge judge{schema::JudgeLimits()};
  model::ReportedShape shape = SampleShape();
  shape.data = model::MultiPoint{model::Positions(8000, {.lon = 1, .lat = 2})};
  for (int round = 0; round < 3; ++round) {
    ExpectGood(judge.Payload(AsPayload(schema::Encode(model::ShapeOp{shape}))));
    ExpectMalformed(judge.Payload(AsPayload("12345678")));
    const schema::Judgement judgement = judge.Payload(AsPayload(schema::Encode(SampleMotion())));
    EXPECT_TRUE(BodyOf<model::MotionTelemetry>(judgement) == SampleMotion());
  }
}

}  // namespace
}  // namespace uplink::test
