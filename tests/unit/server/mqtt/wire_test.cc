#include "server/mqtt/wire.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <variant>

#include <gtest/gtest.h>

#include "server/mqtt/limits.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::mqtt {
namespace {

using testing::MqttField;
using testing::MqttLength;
using testing::MqttU16;
using testing::PublishBytes;
using testing::Raw;

/// The first packet, or fault, in bytes that come `piece` at a time, and the most that was kept.
struct First {
  std::variant<std::monostate, Publish, Fault> found;
  std::size_t kept_max = 0;
};

First FirstIn(Wire& wire, std::string_view bytes, std::size_t piece) {
  First first;
  while (!bytes.empty()) {
    std::string_view next = bytes.substr(0, piece);
    bytes.remove_prefix(next.size());
    while (true) {
      const Wire::Step step = wire.Take(next);
      next.remove_prefix(step.taken);
      first.kept_max = std::max(first.kept_max, wire.kept_bytes());
      if (const auto* packet = std::get_if<Packet>(&step.found)) {
        first.found = std::get<Publish>(*packet);
        return first;
      }
      if (const auto* fault = std::get_if<Fault>(&step.found)) {
        first.found = *fault;
        return first;
      }
      if (std::holds_alternative<Wire::More>(step.found)) break;
    }
  }
  return first;
}

TEST(MqttWire, AMessageOverTheBoundIsReadPastAndNeverHeld) {
  const std::string bytes =
      PublishBytes{.topic = "depth", .payload = std::string(800'000, 'x'), .id = 5}.Text();
  Wire wire(Version::k5, 64 * 1024);
  const First first = FirstIn(wire, bytes, 1000);
  ASSERT_TRUE(std::holds_alternative<Publish>(first.found));
  const auto& message = std::get<Publish>(first.found);
  EXPECT_EQ(message.topic, "depth");
  EXPECT_EQ(message.id, 5);
  EXPECT_FALSE(message.payload.has_value());
  EXPECT_EQ(message.payload_bytes, 800'000U);
  EXPECT_LT(first.kept_max, 64U);
}

TEST(MqttWire, APacketInOnePieceIsReadWhereItLies) {
  const std::string bytes = PublishBytes{.payload = "hello"}.Text();
  Wire wire(Version::k5, 64);
  const First first = FirstIn(wire, bytes, bytes.size());
  EXPECT_EQ(std::get<Publish>(first.found).payload->data(), bytes.data() + bytes.size() - 5);
  EXPECT_EQ(first.kept_max, 0U);
}

TEST(MqttWire, TheLongestTopicIsTaken) {
  const std::string topic(kFieldBytesMax, 't');
  for (const Version version : {Version::k311, Version::k5}) {
    Wire wire(version, 64);
    const std::string bytes =
        PublishBytes{.topic = topic, .payload = "p", .mqtt5 = version == Version::k5}.Text();
    const First first = FirstIn(wire, bytes, 4096);
    ASSERT_TRUE(std::holds_alternative<Publish>(first.found));
    EXPECT_EQ(std::get<Publish>(first.found).topic, topic);
  }
}

/// A PUBLISH whose head has `bytes` bytes.
std::string MessageWithHead(std::size_t bytes) {
  // Topic 3, length of properties 3; a user property has 5 beside its texts.
  std::size_t left = bytes - 6;
  std::string properties;
  while (left > 0) {
    const std::size_t property = left > 60'010 ? 60'000 : left;
    properties += '\x26' + MqttField("") + MqttField(std::string(property - 5, 'v'));
    left -= property;
  }
  return PublishBytes{.payload = "p", .properties = properties}.Text();
}

TEST(MqttWire, AHeadAtItsBoundIsTakenAndOnePastItIsReadPast) {
  for (const std::size_t piece : {std::size_t{1000}, std::size_t{1'000'000}}) {
    Wire wire(Version::k5, 64);
    const std::string at_bound = MessageWithHead(kHeadBytesMax);
    const First good = FirstIn(wire, at_bound, piece);
    ASSERT_TRUE(std::holds_alternative<Publish>(good.found));
    EXPECT_EQ(std::get<Publish>(good.found).payload, "p");
    EXPECT_FALSE(std::get<Publish>(good.found).head_unread);
    const std::string past_bound = MessageWithHead(kHeadBytesMax + 1);
    const First large = FirstIn(wire, past_bound, piece);
    ASSERT_TRUE(std::holds_alternative<Publish>(large.found));
    const auto& message = std::get<Publish>(large.found);
    EXPECT_EQ(message.topic, "t");
    EXPECT_TRUE(message.head_unread);
    EXPECT_FALSE(message.payload.has_value());
    EXPECT_EQ(message.payload_bytes, kHeadBytesMax + 2) << "all of it";
    EXPECT_LE(large.kept_max, kHeadBytesMax + 1) << "the rest of the first one, and no more";
    const std::string small = MessageWithHead(20);
    const First next = FirstIn(wire, small, piece);
    ASSERT_TRUE(std::holds_alternative<Publish>(next.found));
    EXPECT_EQ(std::get<Publish>(next.found).payload, "p");
  }
}

TEST(MqttWire, OfAHeadThatIsTooLargeNoMoreThanTheTopicIsKept) {
  Wire wire(Version::k5, 64);
  EXPECT_LE(FirstIn(wire, MessageWithHead(1'000'000), 1000).kept_max, 16U);
}

TEST(MqttWire, CorrelationDataPastItsBoundIsLeftOut) {
  for (const std::size_t bytes : {kCorrelationBytesMax, kCorrelationBytesMax + 1}) {
    Wire wire(Version::k5, 64);
    const std::string message =
        PublishBytes{.properties = '\x09' + MqttField(std::string(bytes, 'c'))}.Text();
    const First first = FirstIn(wire, message, message.size());
    EXPECT_EQ(std::get<Publish>(first.found).correlation.size(),
              bytes <= kCorrelationBytesMax ? bytes : 0);
  }
}

TEST(MqttWire, ALengthThatLiesHoldsNoMemory) {
  // The largest packet by its length, and only a few bytes come.
  Wire wire(Version::k311, 64);
  const std::string bytes = Raw("\x30") + MqttLength(kRemainingLengthMax) + MqttField("t") + "abc";
  const First first = FirstIn(wire, bytes, bytes.size());
  EXPECT_TRUE(std::holds_alternative<std::monostate>(first.found));
  EXPECT_LT(first.kept_max, 8U);
}

TEST(MqttWire, TellsThatAMessageOfQos1BeginsBeforeItTakesIt) {
  Wire wire(Version::k311, 64);
  const std::string bytes = PublishBytes{.id = 1, .mqtt5 = false}.Text();
  const Wire::Step step = wire.Take(bytes);
  EXPECT_EQ(step.taken, 2U);
  ASSERT_TRUE(std::holds_alternative<Wire::Opened>(step.found));
  EXPECT_TRUE(std::get<Wire::Opened>(step.found).is_qos1);
  Wire other(Version::k311, 64);
  const std::string ping = Raw("\xD0\0");
  const Wire::Step pong = other.Take(ping);
  EXPECT_FALSE(std::get<Wire::Opened>(pong.found).is_qos1);
}

}  // namespace
}  // namespace uplink::mqtt
