#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "server/mqtt/limits.h"
#include "server/mqtt/wire.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::mqtt {
namespace {

using testing::MqttField;
using testing::MqttLength;
using testing::MqttPacket;
using testing::MqttProperties;
using testing::PublishBytes;
using testing::Raw;

constexpr std::size_t kPayloadMax = 64;

/// What a broker's bytes are taken for, as text.
std::string TextOf(const Packet& packet) {
  if (const auto* connack = std::get_if<Connack>(&packet)) {
    return "connack " + std::to_string(connack->code) +
           (connack->session_present ? " present" : "") +
           (connack->server_keepalive_seconds
                ? " keepalive " + std::to_string(*connack->server_keepalive_seconds)
                : "") +
           (connack->session_expiry_seconds
                ? " expiry " + std::to_string(*connack->session_expiry_seconds)
                : "") +
           (connack->packet_bytes_max ? " max " + std::to_string(*connack->packet_bytes_max) : "") +
           (connack->reason.empty() ? "" : " '" + std::string(connack->reason) + "'");
  }
  if (const auto* message = std::get_if<Publish>(&packet)) {
    return "publish " + std::string(message->topic) +
           (message->id > 0 ? " id " + std::to_string(message->id) : "") +
           (message->dup ? " dup" : "") + (message->retained ? " retained" : "") +
           (message->has_response_topic ? " response" : "") +
           (message->bad_topic ? " bad topic" : "") + (message->head_unread ? " headless" : "") +
           (message->correlation.empty() ? "" : " c=" + std::string(message->correlation)) +
           (message->payload ? " '" + std::string(*message->payload) + "'" : " unread") + " " +
           std::to_string(message->payload_bytes);
  }
  const auto codes = [](PacketId id, std::string_view bytes) {
    std::string text = std::to_string(id);
    for (const char each : bytes) text += " " + std::to_string(static_cast<unsigned char>(each));
    return text;
  };
  if (const auto* suback = std::get_if<Suback>(&packet)) {
    return "suback " + codes(suback->id, suback->codes);
  }
  if (const auto* unsuback = std::get_if<Unsuback>(&packet)) {
    return "unsuback " + codes(unsuback->id, unsuback->codes);
  }
  if (const auto* farewell = std::get_if<Disconnect>(&packet)) {
    return "disconnect " + std::to_string(farewell->code) +
           (farewell->reason.empty() ? "" : " '" + std::string(farewell->reason) + "'");
  }
  return "pingresp";
}

/// All that is found in bytes that come in these pieces, a line each; a fault ends it.
std::string FoundIn(Version version, const std::vector<std::string_view>& pieces) {
  Wire wire(version, kPayloadMax);
  std::string found;
  for (std::string_view next : pieces) {
    while (true) {
      const Wire::Step step = wire.Take(next);
      next.remove_prefix(step.taken);
      if (std::holds_alternative<Wire::More>(step.found)) break;
      if (std::holds_alternative<Wire::Opened>(step.found)) continue;
      if (const auto* fault = std::get_if<Fault>(&step.found)) {
        EXPECT_TRUE(std::holds_alternative<Fault>(wire.Take(next).found)) << "it stays broken";
        return found + std::string(Name(fault->reason));
      }
      found += TextOf(std::get<Packet>(step.found)) + "\n";
    }
    EXPECT_TRUE(next.empty()) << "More means that all was taken";
  }
  return found;
}

std::vector<std::string_view> PiecesOf(std::string_view bytes, std::size_t size) {
  std::vector<std::string_view> pieces;
  for (; !bytes.empty(); bytes.remove_prefix(pieces.back().size())) {
    pieces.push_back(bytes.substr(0, size));
  }
  return pieces;
}

struct Case {
  Version version;
  std::string bytes;
  /// What is found.
  std::string found;
};

constexpr auto k3 = Version::k311;
constexpr auto k5 = Version::k5;

std::vector<Case> Connacks() {
  return {
      {k3, Raw("\x20\2\0\0"), "connack 0\n"},
      {k3, Raw("\x20\2\1\0"), "connack 0 present\n"},
      {k3, Raw("\x20\2\0\5"), "connack 5\n"},
      {k3, Raw("\x20\2\1\5"), "malformed"},
      {k3, Raw("\x20\2\2\0"), "malformed"},
      {k3, Raw("\x20\1\0"), "malformed"},
      {k3, Raw("\x20\0"), "malformed"},
      {k3, Raw("\x20\3\0\0\0"), "malformed"},
      {k3, Raw("\x21\2\0\0"), "malformed"},
      {k5, Raw("\x20\3\0\0\0"), "connack 0\n"},
      {k5, Raw("\x20\2\0\0"), "malformed"},
      {k5, Raw("\x20\2\0\1"), "connack 1\n"},  // of a broker that has 3.1.1 alone
      {k5, Raw("\x20\2\0\5"), "connack 5\n"},
      {k5, Raw("\x20\2\0\6"), "malformed"},
      {k5, Raw("\x20\2\1\1"), "malformed"},
      {k5, Raw("\x20\3\1\x87\0"), "malformed"},
      {k5, Raw("\x20\4\0\0\0\0"), "malformed"},
      {k5, MqttPacket(0x20, Raw("\1\0") + MqttProperties(Raw("\x13\0\x1E\x27\0\0\1\0"))),
       "connack 0 present keepalive 30 max 256\n"},
      {k5, MqttPacket(0x20, Raw("\0\x87") + MqttProperties(Raw("\x1F\0\2no"))),
       "connack 135 'no'\n"},
      {k5, MqttPacket(0x20, Raw("\0\0\4\x13\0\x1E")), "malformed"},  // they end past the packet
  };
}

std::vector<Case> Answers() {
  return {
      {k3, Raw("\x90\5\0\7\0\1\x80"), "suback 7 0 1 128\n"},
      {k3, Raw("\x90\3\0\7\2"), "suback 7 2\n"},
      {k3, Raw("\x90\3\0\7\3"), "malformed"},
      {k3, Raw("\x90\3\0\7\x87"), "malformed"},
      {k3, Raw("\x90\2\0\7"), "malformed"},
      {k3, Raw("\x90\3\0\0\1"), "malformed"},
      {k3, Raw("\x90\1\0"), "malformed"},
      {k3, Raw("\x92\3\0\7\1"), "malformed"},
      {k5, Raw("\x90\5\0\7\0\1\x87"), "suback 7 1 135\n"},
      {k5, MqttPacket(0x90, Raw("\0\7") + MqttProperties(Raw("\x1F\0\1x\x26\0\1a\0\1b")) + "\1"),
       "suback 7 1\n"},
      {k5, Raw("\x90\3\0\7\0"), "malformed"},
      {k5, Raw("\x90\4\0\7\0\3"), "malformed"},
      {k5, Raw("\x90\4\0\7\5\1"), "malformed"},
      {k3, Raw("\xB0\2\0\7"), "unsuback 7\n"},
      {k3, Raw("\xB0\3\0\7\0"), "malformed"},
      {k5, Raw("\xB0\5\0\7\0\0\x11"), "unsuback 7 0 17\n"},
      {k5, Raw("\xB0\3\0\7\0"), "malformed"},
      {k3, Raw("\xD0\0"), "pingresp\n"},
      {k5, Raw("\xD0\0"), "pingresp\n"},
      {k5, Raw("\xD0\1\0"), "malformed"},
      {k5, Raw("\xD1\0"), "malformed"},
      {k3, Raw("\xE0\0"), "unexpected_packet"},
      {k5, Raw("\xE0\0"), "disconnect 0\n"},
      {k5, Raw("\xE0\1\x8E"), "disconnect 142\n"},
      {k5, Raw("\xE0\2\x8B\0"), "disconnect 139\n"},
      {k5, MqttPacket(0xE0, "\x8B" + MqttProperties(Raw("\x1F\0\3bye\x1C\0\1s"))),
       "disconnect 139 'bye'\n"},
      {k5, Raw("\xE0\3\x8B\0\0"), "malformed"},
      {k5, MqttPacket(0xE0, "\x8B" + MqttProperties(Raw("\x11\0\0\0\1"))), "malformed"},
  };
}

std::vector<Case> Messages() {
  const auto with = [](std::string properties) {
    return PublishBytes{.payload = "p", .properties = std::move(properties)}.Text();
  };
  return {
      {k3, PublishBytes{.payload = "hello", .mqtt5 = false}.Text(), "publish t 'hello' 5\n"},
      {k3, PublishBytes{.mqtt5 = false}.Text(), "publish t '' 0\n"},
      {k3, PublishBytes{.payload = "x", .id = 9, .dup = true, .mqtt5 = false}.Text(),
       "publish t id 9 dup 'x' 1\n"},
      {k3, PublishBytes{.retained = true, .mqtt5 = false}.Text(), "publish t retained '' 0\n"},
      {k3, Raw("\x38\3\0\1t"), "malformed"},      // QoS 0 with DUP
      {k3, Raw("\x32\5\0\1t\0\0"), "malformed"},  // packet id 0
      {k3, Raw("\x32\3\0\1t"), "malformed"},      // no packet id
      {k3, Raw("\x34\5\0\1t\0\1"), "qos2"},       //
      {k3, Raw("\x36\5\0\1t\0\1"), "malformed"},  // both bits
      {k3, Raw("\x30\3\0\2t"), "malformed"},      // a topic past the packet
      {k3, Raw("\x30\1\0"), "malformed"},         //
      {k3, Raw("\x30\0"), "malformed"},           //
      {k5, with(""), "publish t 'p' 1\n"},
      {k5, Raw("\x30\3\0\1t"), "malformed"},                      // no properties
      {k5, Raw("\x30\4\0\1t\1"), "malformed"},                    // they end past the packet
      {k5, Raw("\x30\4\0\1t\x80"), "malformed"},                  // and so does their length
      {k5, Raw("\x30\x08\0\1t\x80\x80\x80\x80\1"), "malformed"},  // which has four digits at most
      {k5, with(Raw("\1\1\2\0\0\0\1\3\0\4text")), "publish t 'p' 1\n"},
      {k5, with(Raw("\x08\0\1r\x09\0\2id")), "publish t response c=id 'p' 1\n"},
      {k5, with(Raw("\x0B\x80\1\x0B\7")), "publish t 'p' 1\n"},
      {k5, with(Raw("\x26\0\1k\0\1v\x26\0\1k\0\1v")), "publish t 'p' 1\n"},
      {k5, with(Raw("\x23\0\1")), "topic_alias"},
      {k5, with(Raw("\x7F\0")), "unknown_property"},
      {k5, with(Raw("\x00\0")), "unknown_property"},
      {k5, with(Raw("\xFF\0")), "unknown_property"},
  };
}

/// What a broker may pass on as a publisher made it up, without harm to where packets end.
std::vector<Case> Twins() {
  const auto with = [](const std::string& properties) {
    return PublishBytes{.payload = "p", .id = 4, .properties = properties}.Text();
  };
  std::vector<Case> cases = {
      {k3, Raw("\x30\3\0\0x"), "publish  bad topic 'x' 1\n"},
      {k3, Raw("\x30\3\0\1+"), "publish + bad topic '' 0\n"},
      {k3, Raw("\x32\7\0\3a/#\0\2"), "publish a/# id 2 bad topic '' 0\n"},
      {k3, Raw("\x30\4\0\2\xC3\x28"), "publish \xC3\x28 bad topic '' 0\n"},  // no UTF-8
      {k3, Raw("\x30\4\0\2\0a"), Raw("publish \0a bad topic '' 0\n")},
      {k5, Raw("\x30\4\0\1#\0"), "publish # bad topic '' 0\n"},
      {k5, Raw("\x30\3\0\0\0"), "publish  bad topic '' 0\n"},
      {k5, with(Raw("\x08\0\1r\x08\0\1\xFF")), "publish t id 4 response 'p' 1\n"},
      {k5, with(Raw("\x09\0\1a\x09\0\1b")), "publish t id 4 c=b 'p' 1\n"},
  };
  for (const std::string& odd : {
           Raw("\1\2"),               // a switch is 0 or 1
           Raw("\1\0\1\0"),           // twice
           Raw("\3\0\1\xFF"),         // a text that is none
           Raw("\3\0\1\0"),           // NUL
           Raw("\x0B\0"),             // an identifier of 0
           Raw("\x26\0\1\xFF\0\1v"),  //
           Raw("\x26\0\1k\0\1\xFF"),  //
           Raw("\x11\0\0\0\1"),       // another packet's
           Raw("\x13\0\1"),           //
           Raw("\x1F\0\1x"),          //
           Raw("\x21\0\1"),           //
       }) {
    cases.push_back({k5, with(odd) + Raw("\xD0\0"), "publish t id 4 'p' 1\npingresp\n"});
  }
  return cases;
}

std::vector<Case> BadProperties() {
  std::vector<Case> cases;
  for (const std::string& bad : {
           Raw("\1"),                      // no value
           Raw("\2\0\0\1"),                // three bytes of four
           Raw("\3\0\2x"),                 // a text past the end
           Raw("\x09\0"),                  // half a length
           Raw("\x0B\x80\x80\x80\x80\1"),  // five digits
           Raw("\x0B\x80"),                // half of one
           Raw("\x26\0\1k"),               // half a pair
           Raw("\x26\0\1k\0\2v"),          // a pair past the end
       }) {
    cases.push_back({k5, PublishBytes{.properties = bad}.Text(), "malformed"});
  }
  for (const std::string& bad : {
           Raw("\x21\0\0"),           // a Receive Maximum of 0
           Raw("\x27\0\0\0\0"),       // a Maximum Packet Size of 0
           Raw("\x24\2"),             // a Maximum QoS of 2
           Raw("\x25\2"),             //
           Raw("\x13\0"),             //
           Raw("\x13\0\1\x13\0\1"),   // twice
           Raw("\x23\0\1"),           // a PUBLISH's
           Raw("\x09\0\1a"),          //
           Raw("\x1F\0\1\xFF"),       // a text that is none
           Raw("\x1F\0\1\0"),         // NUL
           Raw("\x26\0\1\xFF\0\1v"),  //
           Raw("\x26\0\1k\0\1\xFF"),  //
           Raw("\x26\0\1k"),          // half a pair
           Raw("\1\1"),               // a PUBLISH's
       }) {
    cases.push_back({k5, MqttPacket(0x20, Raw("\0\0") + MqttProperties(bad)), "malformed"});
  }
  // All that a CONNACK may have.
  const std::string all =
      Raw("\x11\0\0\0\1\x12\0\1c\x13\0\1\x15\0\1m\x16\0\1\0\x1A\0\1r\x1C\0\1s\x1F\0\1x\x21\0\1"
          "\x22\0\1\x24\1\x25\1\x26\0\1k\0\1v\x27\0\0\1\0\x28\1\x29\1\x2A\0");
  cases.push_back({k5, MqttPacket(0x20, Raw("\0\0") + MqttProperties(all)),
                   "connack 0 keepalive 1 expiry 1 max 256 'x'\n"});
  return cases;
}

std::vector<Case> Openings() {
  std::vector<Case> cases;
  // Types that no broker sends to a subscriber: those of clients, those of QoS 2, AUTH, none.
  for (const unsigned type : {0U, 1U, 4U, 5U, 6U, 7U, 8U, 10U, 12U, 15U}) {
    cases.push_back({k5, MqttPacket(type << 4U, Raw("\0\1")), "unexpected_packet"});
    cases.push_back({k3, MqttPacket(type << 4U, Raw("\0\1")), "unexpected_packet"});
  }
  cases.push_back({k3, Raw("\x30\x80\x80\x80\x80\1"), "malformed"});
  cases.push_back({k3, "\x90" + MqttLength(kAnswerBytesMax + 1), "too_large"});
  return cases;
}

std::vector<Case> Sequences() {
  const std::string large(kPayloadMax + 1, 'x');
  const std::string limit(kPayloadMax, 'y');
  const auto publish = [](Version version, std::string payload, std::size_t id) {
    return PublishBytes{.payload = std::move(payload), .id = id, .mqtt5 = version == k5}.Text();
  };
  std::vector<Case> cases;
  for (const Version version : {k3, k5}) {
    cases.push_back({version,
                     publish(version, limit, 0) + publish(version, large, 3) + Raw("\xD0\0") +
                         publish(version, "end", 4),
                     "publish t '" + limit + "' 64\npublish t id 3 unread 65\npingresp\n" +
                         "publish t id 4 'end' 3\n"});
  }
  return cases;
}

class MqttDecode : public ::testing::TestWithParam<Case> {};

TEST_P(MqttDecode, FindsTheSameHoweverTheBytesAreCut) {
  const Case& one = GetParam();
  EXPECT_EQ(FoundIn(one.version, {one.bytes}), one.found);
  for (const std::size_t piece : {1U, 2U, 3U, 5U, 7U}) {
    EXPECT_EQ(FoundIn(one.version, PiecesOf(one.bytes, piece)), one.found) << "of " << piece;
  }
}

TEST_P(MqttDecode, FindsTheSameInTwoPiecesCutAtEachByte) {
  const Case& one = GetParam();
  const std::string_view bytes = one.bytes;
  for (std::size_t cut = 1; cut < bytes.size(); ++cut) {
    EXPECT_EQ(FoundIn(one.version, {bytes.substr(0, cut), bytes.substr(cut)}), one.found)
        << "cut at " << cut;
  }
}

INSTANTIATE_TEST_SUITE_P(Connack, MqttDecode, ::testing::ValuesIn(Connacks()));
INSTANTIATE_TEST_SUITE_P(Answer, MqttDecode, ::testing::ValuesIn(Answers()));
INSTANTIATE_TEST_SUITE_P(Message, MqttDecode, ::testing::ValuesIn(Messages()));
INSTANTIATE_TEST_SUITE_P(Twin, MqttDecode, ::testing::ValuesIn(Twins()));
INSTANTIATE_TEST_SUITE_P(Properties, MqttDecode, ::testing::ValuesIn(BadProperties()));
INSTANTIATE_TEST_SUITE_P(Opening, MqttDecode, ::testing::ValuesIn(Openings()));
INSTANTIATE_TEST_SUITE_P(Sequence, MqttDecode, ::testing::ValuesIn(Sequences()));

}  // namespace
}  // namespace uplink::mqtt
