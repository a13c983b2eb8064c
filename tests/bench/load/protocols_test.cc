// What brokers say, as the benchmarks' clients read it.
#include <string>

#include <gtest/gtest.h>

#include "tests/bench/load/mqtt.h"
#include "tests/bench/load/nats.h"

namespace uplink::bench {
namespace {

using State = MqttPacket::State;
using Kind = NatsSaid::Kind;

/// A PUBLISH to topic `t`, with these bytes behind it.
std::string Publish(char head, const std::string& behind_topic) {
  std::string body;
  AppendMqttText(body, "t");
  body += behind_topic;
  std::string packet(1, head);
  AppendMqttLength(packet, body.size());
  return packet + body;
}

TEST(MqttTest, ReadsAPacketOnceItIsWhole) {
  const std::string packet = Publish(kMqttPublish, "hello");
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_EQ(ReadMqttPacket(packet.substr(0, size)).state, State::kPartial) << size;
  }
  const std::string received = packet + "more";
  const MqttPacket read = ReadMqttPacket(received);
  EXPECT_EQ(read.state, State::kWhole);
  EXPECT_EQ(read.bytes, packet.size());
  EXPECT_EQ(read.head, kMqttPublish);
}

TEST(MqttTest, ReadsWhatItWritesOfEveryLength) {
  for (const std::size_t size : {0U, 127U, 128U, 16'383U, 16'384U, 2'097'152U}) {
    std::string packet(1, kMqttPuback);
    AppendMqttLength(packet, size);
    packet.append(size, 'x');
    const MqttPacket read = ReadMqttPacket(packet);
    EXPECT_EQ(read.state, State::kWhole) << size;
    EXPECT_EQ(read.body.size(), size);
    EXPECT_EQ(read.bytes, packet.size());
  }
}

TEST(MqttTest, ALengthOfMoreThanFourBytesIsMalformed) {
  EXPECT_EQ(ReadMqttPacket("\x30\xFF\xFF\xFF").state, State::kPartial);
  EXPECT_EQ(ReadMqttPacket("\x30\xFF\xFF\xFF\x7F").state, State::kPartial);
  EXPECT_EQ(ReadMqttPacket("\x30\xFF\xFF\xFF\xFF").state, State::kMalformed);
}

TEST(MqttTest, ReadsAMessageOfQos0) {
  const std::string packet = Publish(kMqttPublish, "hello");
  const auto message = ReadMqttPublish(ReadMqttPacket(packet));
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->topic, "t");
  EXPECT_EQ(message->packet, std::nullopt);
  EXPECT_EQ(message->payload, "hello");
}

TEST(MqttTest, ReadsAMessageOfQos1WithItsNumber) {
  const std::string packet = Publish(kMqttPublishQos1, "\x12\x34hello");
  const auto message = ReadMqttPublish(ReadMqttPacket(packet));
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->packet, 0x1234);
  EXPECT_EQ(message->payload, "hello");
}

TEST(MqttTest, AMessageWhoseLengthsDoNotFitIsNone) {
  const auto read = [](const std::string& packet) {
    return ReadMqttPublish(ReadMqttPacket(packet));
  };
  EXPECT_TRUE(read(Publish(kMqttPublishQos1, "\x01\x02")).has_value()) << "an empty payload";
  EXPECT_FALSE(read(Publish(kMqttPublishQos1, "\x01")).has_value()) << "half a number";
  EXPECT_FALSE(read(std::string("\x30\x01\x00", 3)).has_value()) << "half a topic's length";
  EXPECT_FALSE(read(std::string("\x30\x03\x00\x02t", 5)).has_value()) << "half a topic";
  EXPECT_FALSE(read(Publish('\x34', "\x01\x02")).has_value()) << "QoS 2";
  EXPECT_FALSE(read(Publish(kMqttPuback, "")).has_value()) << "no PUBLISH";
}

TEST(MqttTest, SubscribesToOneTopic) {
  EXPECT_EQ(MqttSubscribePacket("t", 1), std::string("\x82\x06\x00\x01\x00\x01t\x01", 8));
}

TEST(NatsTest, ReadsAMessageOnceItIsWhole) {
  const std::string message = "MSG fleet 1 7\r\nhe\r\nllo\r\n";
  for (std::size_t size = 0; size < message.size(); ++size) {
    EXPECT_EQ(ReadNats(message.substr(0, size)).kind, Kind::kPartial) << size;
  }
  const std::string received = message + "PING\r\n";
  const NatsSaid said = ReadNats(received);
  EXPECT_EQ(said.kind, Kind::kMessage);
  EXPECT_EQ(said.text, "he\r\nllo");
  EXPECT_EQ(said.bytes, message.size());
}

TEST(NatsTest, AMessageWhoseLengthDoesNotFitIsMalformed) {
  EXPECT_EQ(ReadNats("MSG fleet 1 0\r\n\r\n").kind, Kind::kMessage);
  EXPECT_EQ(ReadNats("MSG fleet 1 4\r\nhello\r\n").kind, Kind::kMalformed);
  EXPECT_EQ(ReadNats("MSG fleet 1 five\r\nhello\r\n").kind, Kind::kMalformed);
  EXPECT_EQ(ReadNats("MSG fleet 1 \r\nhello\r\n").kind, Kind::kMalformed);
  EXPECT_EQ(ReadNats("MSG fleet 1 18446744073709551615\r\nhello\r\n").kind, Kind::kPartial);
}

TEST(NatsTest, TellsLinesApart) {
  EXPECT_EQ(ReadNats("PING\r\n").kind, Kind::kPing);
  EXPECT_EQ(ReadNats("PONG\r\n").kind, Kind::kPong);
  EXPECT_EQ(ReadNats("INFO {}\r\n").kind, Kind::kOther);
  const NatsSaid said = ReadNats("-ERR 'Slow Consumer'\r\n");
  EXPECT_EQ(said.kind, Kind::kError);
  EXPECT_EQ(said.text, "-ERR 'Slow Consumer'");
}

}  // namespace
}  // namespace uplink::bench
