#include "server/mqtt/encode.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/mqtt/limits.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::mqtt {
namespace {

using testing::MqttField;
using testing::MqttPacket;
using testing::Raw;

TEST(MqttEncode, ConnectOf311SaysNameVersionFlagsAndFields) {
  const Connect connect{.version = Version::k311,
                        .client_id = "core",
                        .clean = false,
                        .keepalive_seconds = 300,
                        .username = "me",
                        .password = "secret",
                        .session_expiry_seconds = 1,
                        .receive_maximum = 2};
  EXPECT_EQ(EncodeConnect(connect),
            MqttPacket(0x10, Raw("\0\4MQTT\4\xC0\1\x2C") + MqttField("core") + MqttField("me") +
                                 MqttField("secret")));
}

TEST(MqttEncode, ConnectOf311WithoutPasswordIsClean) {
  const Connect connect{.version = Version::k311, .client_id = "c", .keepalive_seconds = 60};
  EXPECT_EQ(EncodeConnect(connect), MqttPacket(0x10, Raw("\0\4MQTT\4\2\0\x3C\0\1c")));
}

TEST(MqttEncode, ConnectOf5SaysItsProperties) {
  const Connect connect{.version = Version::k5,
                        .client_id = "c",
                        .clean = false,
                        .keepalive_seconds = 60,
                        .session_expiry_seconds = 86'400,
                        .receive_maximum = 1024,
                        .packet_bytes_max = 70'000};
  EXPECT_EQ(EncodeConnect(connect),
            MqttPacket(0x10, Raw("\0\4MQTT\5\0\0\x3C\x0D\x11\0\1\x51\x80\x21\4\0\x27\0\1\x11\x70"
                                 "\0\1c")));
}

TEST(MqttEncode, SubscribeAsksForNoRetainedMessagesWhereItCan) {
  const std::vector<Filter> filters = {{"a/#", Qos::kAtLeastOnce}, {"b", Qos::kAtMostOnce}};
  EXPECT_EQ(EncodeSubscribe(Version::k311, 7, filters),
            MqttPacket(0x82, Raw("\0\7\0\3a/#\1\0\1b\0")));
  EXPECT_EQ(EncodeSubscribe(Version::k5, 7, filters),
            MqttPacket(0x82, Raw("\0\7\0\0\3a/#\x21\0\1b\x20")));
}

TEST(MqttEncode, Unsubscribe) {
  const std::vector<std::string> topics = {"a/#", "b"};
  EXPECT_EQ(EncodeUnsubscribe(Version::k311, 258, topics),
            MqttPacket(0xA2, Raw("\1\2\0\3a/#\0\1b")));
  EXPECT_EQ(EncodeUnsubscribe(Version::k5, 258, topics),
            MqttPacket(0xA2, Raw("\1\2\0\0\3a/#\0\1b")));
}

TEST(MqttEncode, PacketsOfFewBytes) {
  EXPECT_EQ(EncodePuback(0xFFFE), Raw("\x40\2\xFF\xFE"));
  EXPECT_EQ(EncodePingreq(), Raw("\xC0\0"));
  EXPECT_EQ(EncodeDisconnect(Version::k311, 0x81), Raw("\xE0\0"));
  EXPECT_EQ(EncodeDisconnect(Version::k5, 0), Raw("\xE0\0"));
  EXPECT_EQ(EncodeDisconnect(Version::k5, 0x81), Raw("\xE0\1\x81"));
}

TEST(MqttEncode, PublishEchoesCorrelationDataWhereItCan) {
  const Outgoing message{.topic = "p", .payload = "{}", .correlation = "x"};
  EXPECT_EQ(EncodePublish(Version::k311, message), MqttPacket(0x30, Raw("\0\1p{}")));
  EXPECT_EQ(EncodePublish(Version::k5, message), MqttPacket(0x30, Raw("\0\1p\4\x09\0\1x{}")));
  EXPECT_EQ(EncodePublish(Version::k5, {.topic = "p", .payload = "{}"}),
            MqttPacket(0x30, Raw("\0\1p\0{}")));
}

TEST(MqttEncode, LengthsHaveAsManyDigitsAsTheyNeed) {
  // One, two and three digits; two bytes are the topic's length, one is the topic.
  for (const std::size_t bytes : {127U, 128U, 16'383U, 16'384U}) {
    const Outgoing message{.topic = "p", .payload = std::string(bytes - 3, 'x')};
    EXPECT_EQ(EncodePublish(Version::k311, message),
              MqttPacket(0x30, Raw("\0\1p") + message.payload))
        << bytes;
  }
}

TEST(MqttEncodeDeathTest, AFieldThatMqttCannotSayIsOurMistake) {
  const Outgoing message{.topic = std::string(kFieldBytesMax + 1, 't')};
  EXPECT_DEATH(static_cast<void>(EncodePublish(Version::k311, message)), "longer than MQTT can");
}

}  // namespace
}  // namespace uplink::mqtt
