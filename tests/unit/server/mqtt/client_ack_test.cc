// Which messages a client gives to its listener, and which PUBACKs follow.
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/mqtt/client.h"
#include "server/mqtt/encode.h"
#include "server/mqtt/limits.h"
#include "tests/unit/server/mqtt/client_bench.h"

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::ClientBench;
using testing::MqttField;
using testing::PublishBytes;
using testing::Raw;
using ::testing::SizeIs;

TEST(MqttClientAck, WhatIsReleasedTogetherIsAckedByOneWrite) {
  ClientBench bench([](ClientSettings& settings) { settings.unacked_max = 3; });
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("1", 7) + bench.MessageBytes("2", 8) +
                    bench.MessageBytes("3", 9));
  std::vector<AckHandle> handles;
  for (const auto& each : bench.messages) handles.push_back(*each.ack);
  bench.client->Release(handles);
  EXPECT_EQ(bench.link->written, EncodePuback(7) + EncodePuback(8) + EncodePuback(9));
  bench.link->events()->OnDown({EndReason::kClosed, "closed"});
  bench.client->Release(handles);
  EXPECT_EQ(bench.probe.releases_late.value(), 3);
}

TEST(MqttClientAck, AHandleOfAClientThatIsGoneMeansNothingToTheNext) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("x", 5));
  bench.Renew();
  bench.client->Start();
  bench.Connect(true);
  bench.link->Bring(bench.MessageBytes("y", 6));
  bench.client->Release(*bench.messages[0].ack);
  EXPECT_EQ(bench.Written(), "") << "y is not stored";
  EXPECT_EQ(bench.probe.releases_late.value(), 1);
  bench.client->Release(*bench.messages[1].ack);
  EXPECT_EQ(bench.Written(), EncodePuback(6));
}

TEST(MqttClientAck, ARedeliveryThatCrossesOurAckIsToldAndNotAckedAgain) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("x", 5));
  bench.client->Release(*bench.messages[0].ack);
  EXPECT_EQ(bench.Written(), EncodePuback(5));
  bench.link->Bring(bench.MessageBytes("x", 5, true) + bench.MessageBytes("other", 5));
  ASSERT_THAT(bench.messages, SizeIs(3));
  EXPECT_TRUE(bench.messages[1].again);
  EXPECT_FALSE(bench.messages[1].ack);
  EXPECT_FALSE(bench.messages[2].again);
  EXPECT_EQ(bench.probe.crossed.value(), 1);
  EXPECT_EQ(bench.client->status().unacked, 1U);
  bench.client->Release(*bench.messages[2].ack);
  EXPECT_EQ(bench.Written(), EncodePuback(5));
  bench.link->events()->OnDown({EndReason::kClosed, "closed"});
  bench.Advance(1s);
  bench.Connect(true);
  bench.link->Bring(bench.MessageBytes("other", 5, true));
  EXPECT_FALSE(bench.messages[3].again) << "our PUBACK was lost with its connection";
  bench.client->Release(*bench.messages[3].ack);
  EXPECT_EQ(bench.Written(), EncodePuback(5));
}

TEST(MqttClientAck, ReleasesWithinTheCallAreWrittenAfterIt) {
  ClientBench bench;
  bench.on_message = [&] { bench.client->Release(*bench.messages.back().ack); };
  bench.Begin();
  std::string all;
  std::string acks;
  for (std::size_t id = 1; id <= 5; ++id) {
    all += bench.MessageBytes("x", id);
    acks += EncodePuback(static_cast<PacketId>(id));
  }
  bench.link->Bring(all);
  EXPECT_EQ(bench.Written(), acks);
}

TEST(MqttClientAck, ABrokerThatFloodsAndReadsNothingIsReadNoFurther) {
  ClientBench bench;
  bench.on_message = [&] { bench.client->Release(*bench.messages.back().ack); };
  bench.Begin();
  constexpr int kBatch = 1000;
  std::string batch;
  for (std::size_t id = 1; id <= kBatch; ++id) batch += bench.MessageBytes("", id);
  constexpr std::int64_t kPubackBytes = 4;
  constexpr std::int64_t kAcksMax = std::int64_t{kQueueBytesMax} / kPubackBytes;
  for (int i = 0; i <= kAcksMax / kBatch + 1 && bench.link->reading; ++i) bench.link->Bring(batch);
  EXPECT_FALSE(bench.link->reading);
  EXPECT_EQ(bench.probe.pubacks.value(), kAcksMax) << "each had to wait";
  EXPECT_EQ(bench.probe.stopped_by_output.value(), 1);
  bench.Flush();
  EXPECT_TRUE(bench.link->reading) << "all was written";
  EXPECT_GT(bench.probe.pubacks.value(), kAcksMax) << "what had come and was not taken";
  EXPECT_EQ(bench.probe.stopped_by_output.value(), 0);
  bench.Advance(kAnswerWait);
  EXPECT_THAT(bench.ends, SizeIs(0));
}

TEST(MqttClientAck, WhatAPublisherMadeUpIsGivenAndAckedAndEndsNothing) {
  ClientBench bench([](ClientSettings& settings) { settings.unacked_max = 3; });
  bench.Begin();
  std::string large;
  for (int i = 0; i < 4; ++i) {
    large += "\x26" + MqttField("k") + MqttField(std::string(60'000, 'v'));
  }
  bench.link->Bring(PublishBytes{.payload = "format", .id = 1, .properties = Raw("\1\2")}.Text() +
                    PublishBytes{.payload = "large", .id = 2, .properties = large}.Text() +
                    PublishBytes{.topic = "a/\xFF", .payload = "topic", .id = 3}.Text());
  ASSERT_THAT(bench.messages, SizeIs(3));
  EXPECT_EQ(bench.messages[0].payload, "format");
  EXPECT_FALSE(bench.messages[1].read);
  EXPECT_GT(bench.messages[1].bytes, 240'000U);
  EXPECT_EQ(bench.messages[1].topic, "t");
  EXPECT_TRUE(bench.messages[2].bad_topic);
  EXPECT_EQ(bench.messages[2].topic, "a/\xFF");
  for (const auto& each : bench.messages) bench.client->Release(*each.ack);
  EXPECT_EQ(bench.Written(), EncodePuback(1) + EncodePuback(2) + EncodePuback(3));
  EXPECT_THAT(bench.ends, SizeIs(0));
  EXPECT_EQ(bench.probe.oversized.value(), 1);
  EXPECT_EQ(bench.probe.bad_topics.value(), 1);
}

}  // namespace
}  // namespace uplink::mqtt
