#include "tests/support/mqtt_publisher.h"

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "tests/support/eventually.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::testing {

MqttPublisher::MqttPublisher(std::uint16_t port, const std::string& id, const std::string& user,
                             const std::string& password)
    : tcp_(port) {
  const unsigned flags = user.empty() ? 0x02U : 0xC2U;
  std::string body = MqttField("MQTT");
  body += '\4';
  body += static_cast<char>(flags);
  body += MqttU16(0) + MqttField(id);
  if (!user.empty()) body += MqttField(user) + MqttField(password);
  Send(MqttPacket(0x10, body));
  Expect(std::string_view("\x20\2\0\0", 4));
}

MqttPublisher::MqttPublisher(std::uint16_t port, Mqtt5 /*version*/) : tcp_(port) {
  Send(MqttPacket(0x10, MqttField("MQTT") + std::string("\5\2\0\0\0", 5) + MqttField("publisher")));
  ExpectPacket('\x20');
}

void MqttPublisher::PublishWith(std::string_view properties, std::string_view topic,
                                std::string_view payload) {
  ++id_;
  Send(MqttPacket(
      0x32, MqttField(topic) + MqttU16(id_) + MqttProperties(properties) + std::string(payload)));
  Expect(std::string("\x40\2") + MqttU16(id_));
}

void MqttPublisher::Publish(std::string_view topic, std::string_view payload) {
  ++id_;
  Send(MqttPacket(0x32, MqttField(topic) + MqttU16(id_) + std::string(payload)));
  Expect(std::string("\x40\2") + MqttU16(id_));
}

void MqttPublisher::PublishLive(std::string_view topic, std::string_view payload) {
  Send(MqttPacket(0x30, MqttField(topic) + std::string(payload)));
  Send(std::string_view("\xC0\0", 2));
  Expect(std::string_view("\xD0\0", 2));
}

void MqttPublisher::Send(std::string_view bytes) {
  const SteadyTime deadline = SystemClock{}.Steady() + kPatience;
  while (!bytes.empty()) {
    bytes.remove_prefix(tcp_.SendSome(bytes));
    const bool goes_on = bytes.empty() || tcp_.Wait(RawTcp::For::kInputOrOutput, deadline);
    UPLINK_CHECK(goes_on, "the broker takes bytes");
  }
}

void MqttPublisher::ExpectPacket(char first) {
  constexpr std::size_t kOpening = 2;
  ReceiveBytes(kOpening);
  UPLINK_CHECK(received_[0] == first, "the broker's answer");
  const std::size_t bytes = kOpening + static_cast<unsigned char>(received_[1]);
  ReceiveBytes(bytes);
  received_.erase(0, bytes);
}

void MqttPublisher::Expect(std::string_view bytes) {
  ReceiveBytes(bytes.size());
  UPLINK_CHECK(received_.starts_with(bytes), "the broker's answer");
  received_.erase(0, bytes.size());
}

void MqttPublisher::ReceiveBytes(std::size_t count) {
  const SteadyTime deadline = SystemClock{}.Steady() + kPatience;
  while (received_.size() < count) {
    UPLINK_CHECK(tcp_.end() == RawTcp::End::kNone, "the broker ended a publisher");
    UPLINK_CHECK(tcp_.Wait(RawTcp::For::kInput, deadline), "the broker answers a publisher");
    received_ += tcp_.Receive();
  }
}

}  // namespace uplink::testing
