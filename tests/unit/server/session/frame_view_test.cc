#include "server/session/frame_view.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/server/session/session_bench.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {
namespace {

constexpr std::size_t kUplinksMax = 1'000'000;

/// What protobuf's own parser finds in the same bytes.
FrameContent Parsed(const std::string& bytes, v1::RelayRequest& frame) {
  if (!frame.ParseFromString(bytes)) return FrameContent::kMalformed;
  switch (frame.frame_case()) {
    case v1::RelayRequest::kHello:
      return FrameContent::kHello;
    case v1::RelayRequest::kBatch:
      return FrameContent::kBatch;
    case v1::RelayRequest::kGoodbye:
      return FrameContent::kGoodbye;
    case v1::RelayRequest::FRAME_NOT_SET:
      break;
  }
  return FrameContent::kNothing;
}

void ExpectSame(const UplinkView& view, const v1::Uplink& uplink) {
  EXPECT_EQ(view.seq, uplink.seq());
  switch (uplink.content_case()) {
    case v1::Uplink::kRoverNexus:
      EXPECT_EQ(view.content, UplinkView::Content::kRoverNexus);
      EXPECT_EQ(view.payload, uplink.rover_nexus());
      break;
    case v1::Uplink::kRcanRobotState:
      EXPECT_EQ(view.content, UplinkView::Content::kRcanRobotState);
      EXPECT_EQ(view.payload, uplink.rcan_robot_state());
      break;
    case v1::Uplink::CONTENT_NOT_SET:
      EXPECT_EQ(view.content, UplinkView::Content::kNone);
      break;
  }
}

/// Both readers agree on these bytes.
void ExpectAgreement(const std::string& bytes) {
  BatchView batch;
  v1::RelayRequest frame;
  const FrameContent content = ReadFrame(bytes, batch, kUplinksMax);
  const FrameContent parsed = Parsed(bytes, frame);
  // A group, which no message of ours has: protobuf would skip it.
  if (content == FrameContent::kForeign) return;
  ASSERT_EQ(content, parsed);
  if (content != FrameContent::kBatch) return;
  EXPECT_EQ(batch.head.sent_unix_ms, frame.batch().sent_unix_ms());
  EXPECT_EQ(batch.head.backlog_uplinks.has_value(), frame.batch().has_backlog_uplinks());
  EXPECT_EQ(batch.head.backlog_uplinks.value_or(0), frame.batch().backlog_uplinks());
  EXPECT_EQ(batch.head.oldest_unsent_unix_ms, frame.batch().oldest_unsent_unix_ms());
  ASSERT_EQ(batch.uplinks.size(), static_cast<std::size_t>(frame.batch().uplinks_size()));
  for (std::size_t i = 0; i < batch.uplinks.size(); ++i) {
    ExpectSame(batch.uplinks[i], frame.batch().uplinks(static_cast<int>(i)));
  }
}

std::string Whole() {
  v1::RelayRequest frame = BatchFrame({{1, "one"}, {2, ""}, {1ULL << 63, std::string(300, 'x')}});
  frame.mutable_batch()->set_sent_unix_ms(-5);
  frame.mutable_batch()->set_backlog_uplinks(~std::uint64_t{0});
  frame.mutable_batch()->set_oldest_unsent_unix_ms(-6);
  frame.mutable_batch()->add_uplinks();
  frame.mutable_batch()->add_uplinks()->set_rcan_robot_state("{}");
  return frame.SerializeAsString();
}

TEST(FrameViewTest, ABatchIsViewsIntoItsBytes) {
  const std::string bytes = Whole();
  BatchView batch;
  ASSERT_EQ(ReadFrame(bytes, batch, kUplinksMax), FrameContent::kBatch);
  ASSERT_EQ(batch.uplinks.size(), 5U);
  EXPECT_EQ(batch.uplinks[0].payload, "one");
  EXPECT_GE(batch.uplinks[2].payload.data(), bytes.data());
  EXPECT_LT(batch.uplinks[2].payload.data(), bytes.data() + bytes.size());
  EXPECT_EQ(batch.head.sent_unix_ms, -5);
  EXPECT_EQ(batch.head.backlog_uplinks, ~std::uint64_t{0});
  EXPECT_EQ(batch.head.oldest_unsent_unix_ms, -6);
  ExpectAgreement(bytes);
  // What was read before is gone.
  ASSERT_EQ(ReadFrame(BatchFrame({{9, "z"}}).SerializeAsString(), batch, kUplinksMax),
            FrameContent::kBatch);
  EXPECT_EQ(batch.uplinks.size(), 1U);
  EXPECT_EQ(batch.head.sent_unix_ms, 0);
  EXPECT_FALSE(batch.head.backlog_uplinks) << "not said is not none";
  EXPECT_EQ(batch.head.oldest_unsent_unix_ms, 0);
}

TEST(FrameViewTest, ABacklogOfAnotherTypeIsUnknown) {
  const std::string head = BatchFrame({{1, "one"}}).SerializeAsString();
  // Fields 3 and 4 as text and as 8 bytes; and none of the messages, as 0 and as nothing.
  const std::string bytes("\x1a\x02hi\x21\x01\x02\x03\x04\x05\x06\x07\x08", 13);
  const auto batch = [](const std::string& body) {
    return std::string("\x12", 1) + static_cast<char>(body.size()) + body;
  };
  ExpectAgreement(head + batch(bytes));
  BatchView view;
  ASSERT_EQ(ReadFrame(batch(bytes), view, kUplinksMax), FrameContent::kBatch);
  EXPECT_FALSE(view.head.backlog_uplinks);
  ExpectAgreement(batch(std::string("\x18\x00", 2)));
  ASSERT_EQ(ReadFrame(batch(std::string("\x18\x00", 2)), view, kUplinksMax), FrameContent::kBatch);
  EXPECT_EQ(view.head.backlog_uplinks, 0U);
  // A number without end.
  ExpectAgreement(batch("\x18" + std::string(11, '\xff')));
}

TEST(FrameViewTest, NothingAndHello) {
  ExpectAgreement("");
  ExpectAgreement(HelloFrame(SessionOf(1)).SerializeAsString());
  // An unknown field alone.
  ExpectAgreement("\xa0\x06\x01");
}

TEST(FrameViewTest, TheLastOfAOneofCountsAndPiecesAreJoined) {
  const std::string hello = HelloFrame(SessionOf(1)).SerializeAsString();
  const std::string batch = Whole();
  ExpectAgreement(batch + batch);
  ExpectAgreement(hello + batch);
  ExpectAgreement(batch + hello);
  ExpectAgreement(batch + hello + batch);
  v1::Uplink twice;
  twice.set_rover_nexus("first");
  std::string uplink = twice.SerializeAsString();
  twice.set_rcan_robot_state("second");
  uplink += twice.SerializeAsString();
  std::string within = "\x0a" + std::string(1, static_cast<char>(uplink.size())) + uplink;
  std::string frame = "\x12" + std::string(1, static_cast<char>(within.size())) + within;
  BatchView view;
  ASSERT_EQ(ReadFrame(frame, view, kUplinksMax), FrameContent::kBatch);
  EXPECT_EQ(view.uplinks.at(0).payload, "second");
  ExpectAgreement(frame);
}

TEST(FrameViewTest, EveryCutIsReadAsProtobufReadsIt) {
  const std::string bytes = Whole();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    SCOPED_TRACE(size);
    BatchView batch;
    v1::RelayRequest frame;
    EXPECT_EQ(ReadFrame(bytes.substr(0, size), batch, kUplinksMax),
              Parsed(bytes.substr(0, size), frame));
  }
}

TEST(FrameViewTest, ChangedBytesAreReadAsProtobufReadsThem) {
  const std::string good = BatchFrame({{1, "one"}, {200, "two"}}).SerializeAsString();
  std::mt19937 random(1);
  for (int turn = 0; turn < 20'000; ++turn) {
    std::string bytes = good;
    for (int change = 0; change < 1 + turn % 3; ++change) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    SCOPED_TRACE(::testing::PrintToString(bytes));
    ExpectAgreement(bytes);
  }
}

TEST(FrameViewTest, WhatIsOddIsJudgedByProtobuf) {
  const std::string batch = BatchFrame({{1, "one"}}).SerializeAsString();
  // A hello that is none, before a batch that is one.
  ExpectAgreement(std::string("\x0a\x01\xff", 3) + batch);
  // Sizes and tags in more bytes than they need, and in more than they may have.
  const std::string uplink("\x08\x01\x12\x01z", 5);
  for (const int zeros : {0, 1, 3, 4, 8}) {
    const std::string more(static_cast<std::size_t>(zeros), '\x80');
    std::string size("\x85", 1);
    std::string tag("\x92", 1);
    size += more + std::string(1, '\0');
    tag += more + std::string(1, '\0');
    const auto whole = [](const std::string& body) {
      return std::string("\x12", 1) + static_cast<char>(body.size()) + body;
    };
    SCOPED_TRACE(zeros);
    std::string inside("\x0a", 1);
    inside.append(size).append(uplink);
    ExpectAgreement(whole(inside));
    tag.append(1, static_cast<char>(uplink.size() + 2)).append("\x0a\x05").append(uplink);
    ExpectAgreement(tag);
  }
  // An unknown field whose size does not fit 32 bits.
  ExpectAgreement(batch + std::string("\x7a\x85\x80\x80\x80\x10hello", 11));
  ExpectAgreement(batch + std::string("\x7a\x05hello", 7));
}

TEST(FrameViewTest, AFrameOfNothingLeavesNoMemoryBehind) {
  std::string body;
  for (int i = 0; i < 50'000; ++i) body += std::string("\x0a\x00", 2);
  v1::RelayRequest frame;
  ASSERT_TRUE(frame.mutable_batch()->ParseFromString(body));
  BatchView batch;
  ASSERT_EQ(ReadFrame(frame.SerializeAsString(), batch, kUplinksMax), FrameContent::kBatch);
  EXPECT_EQ(batch.uplinks.size(), 50'000U);
  ASSERT_EQ(ReadFrame(BatchFrame({{1, "one"}}).SerializeAsString(), batch, kUplinksMax),
            FrameContent::kBatch);
  EXPECT_LT(batch.uplinks.capacity(), 5'000U);
}

TEST(FrameViewTest, NestingWithoutEndIsMalformed) {
  // Groups within groups, a hundred and more deep.
  const std::string groups(200, '\x1b');
  BatchView batch;
  EXPECT_EQ(ReadFrame(groups, batch, kUplinksMax), FrameContent::kForeign);
}

TEST(FrameViewTest, MoreUnknownFieldsThanAnyVersionSendsAreForeign) {
  BatchView batch;
  const std::string unknown("\x7a\x00", 2);  // field 15, empty
  const auto frame = [&](std::size_t fields) {
    std::string bytes("\x12\x00", 2);  // an empty batch
    for (std::size_t i = 0; i < fields; ++i) bytes += unknown;
    return bytes;
  };
  EXPECT_EQ(ReadFrame(frame(256), batch, kUplinksMax), FrameContent::kBatch);
  EXPECT_EQ(ReadFrame(frame(257), batch, kUplinksMax), FrameContent::kForeign);
}

TEST(FrameViewTest, AHelloThatIsFarTooLargeIsForeign) {
  BatchView batch;
  v1::RelayRequest frame;
  frame.mutable_hello()->set_agent_version(std::string(16 * 1024 - 7, 'a'));
  const std::size_t over = frame.ByteSizeLong() - 16 * 1024;
  frame.mutable_hello()->mutable_agent_version()->resize(16 * 1024 - 7 - over);
  ASSERT_EQ(frame.ByteSizeLong(), 16U * 1024);
  EXPECT_EQ(ReadFrame(frame.SerializeAsString(), batch, kUplinksMax), FrameContent::kHello);
  frame.mutable_hello()->mutable_agent_version()->push_back('a');
  EXPECT_EQ(ReadFrame(frame.SerializeAsString(), batch, kUplinksMax), FrameContent::kForeign);
}

TEST(FrameViewTest, HundredsOfPartsAreForeign) {
  BatchView batch;
  const std::string part("\x0a\x00\x12\x00", 4);  // an empty hello, an empty batch
  std::string bytes;
  for (int i = 0; i < 136; ++i) bytes += part;
  EXPECT_EQ(ReadFrame(bytes, batch, kUplinksMax), FrameContent::kBatch);
  bytes += part;
  EXPECT_EQ(ReadFrame(bytes, batch, kUplinksMax), FrameContent::kForeign);
}

TEST(FrameViewTest, MessagesPastTheLimitAreOnlyCounted) {
  BatchView batch;
  // Two empty messages, and a Hello before that is none: protobuf would refuse it.
  const std::string bytes("\x0a\x01\xff\x12\x04\x0a\x00\x0a\x00", 9);
  EXPECT_EQ(ReadFrame(bytes, batch, 2), FrameContent::kMalformed);
  EXPECT_EQ(ReadFrame(bytes, batch, 1), FrameContent::kBatch);
  EXPECT_EQ(batch.uplinks.size(), 2U);
}

}  // namespace
}  // namespace uplink::session
