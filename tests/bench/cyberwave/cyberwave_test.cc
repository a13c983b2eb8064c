// What the benchmark of reading a broker publishes, and how it reads what came of it.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/judge.h"
#include "tests/bench/cyberwave/messages.h"
#include "tests/bench/load/mqtt.h"
#include "tests/bench/page.h"

namespace uplink::bench {
namespace {

namespace cw = model::cyberwave;

cyberwave::Judgement JudgementOf(const PublishPacket& packet) {
  const MqttPacket read = ReadMqttPacket(packet.bytes);
  EXPECT_EQ(read.state, MqttPacket::State::kWhole);
  EXPECT_EQ(read.bytes, packet.bytes.size());
  const auto message = ReadMqttPublish(read);
  if (!message) {
    ADD_FAILURE() << "no PUBLISH";
    return {};
  }
  return cyberwave::JudgeMessage(message->topic, message->payload, {});
}

TEST(CyberwaveMessagesTest, JointsAreSixOfTheRobotAndHaveNoFault) {
  const auto packets = JointPackets(3, 2);
  ASSERT_EQ(packets.size(), 6);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const cyberwave::Judgement judgement = JudgementOf(packets[i]);
    EXPECT_EQ(judgement.topic.kind, cyberwave::TopicKind::kJointUpdate);
    EXPECT_EQ(judgement.topic.id.ToText(), TwinId(i % 3));
    EXPECT_TRUE(judgement.sign_of_life);
    EXPECT_THAT(judgement.dropped, ::testing::IsEmpty());
    ASSERT_NE(judgement.body(), nullptr);
    EXPECT_EQ(std::get<cw::Joints>(*judgement.body()).joints.size(), 6);
  }
  EXPECT_NE(packets[0].bytes, packets[3].bytes) << "a step moves them";
}

TEST(CyberwaveMessagesTest, EventsAreDurableAndHaveTheirId) {
  auto packets = EventPackets(2, 2);
  ASSERT_EQ(packets.size(), 4);
  packets[1].SetId(0x1234);
  const auto message = ReadMqttPublish(ReadMqttPacket(packets[1].bytes));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->packet, 0x1234);
  const cyberwave::Judgement judgement = JudgementOf(packets[1]);
  EXPECT_EQ(judgement.message_class, cyberwave::MessageClass::kDurable);
  EXPECT_EQ(judgement.rejection(), nullptr);
}

TEST(CyberwaveMessagesTest, ADepthFrameIsAsLargeAsAsked) {
  const auto packets = DepthPackets(800'000);
  ASSERT_EQ(packets.size(), 1);
  const cyberwave::Judgement judgement = JudgementOf(packets[0]);
  ASSERT_NE(judgement.body(), nullptr);
  EXPECT_EQ(std::get<cw::Media>(*judgement.body()).bytes, 800'000);
}

TEST(PageFiguresTest, SumsWhatBeginsSo) {
  const Samples samples = {{"a{x=\"1\"}", 2}, {"a{x=\"2\"}", 3}, {"ab", 7}, {"b", 11}};
  EXPECT_EQ(SumOf(samples, "a{"), 5);
  EXPECT_EQ(SumOf(samples, "c"), 0);
  EXPECT_EQ(FigureOf(samples, "b"), 11);
  EXPECT_EQ(FigureOf(samples, "c"), 0);
}

TEST(PageFiguresTest, AHistogramSaysWithinWhichTimeAShareLies) {
  // 10 before; then 50 within a millisecond, 49 within ten, one above.
  const Samples before = {
      {"h_bucket{le=\"0.001\"}", 10}, {"h_bucket{le=\"0.01\"}", 10}, {"h_bucket{le=\"+Inf\"}", 10}};
  const Samples after = {{"h_bucket{le=\"0.001\"}", 60},
                         {"h_bucket{le=\"0.01\"}", 109},
                         {"h_bucket{le=\"+Inf\"}", 110}};
  EXPECT_DOUBLE_EQ(HistogramMs(before, after, "h", 0.25), 0.5);
  EXPECT_DOUBLE_EQ(HistogramMs(before, after, "h", 0.5), 1);
  EXPECT_DOUBLE_EQ(HistogramMs(before, after, "h", 0.99), 10);
  EXPECT_DOUBLE_EQ(HistogramMs(before, after, "h", 1), 10) << "over all bounds";
  EXPECT_EQ(HistogramMs(after, after, "h", 0.5), 0) << "nothing came";
  EXPECT_EQ(HistogramMs({}, {}, "h", 0.5), 0);
}

}  // namespace
}  // namespace uplink::bench
