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

void MqttPublisher::Expect(std::string_view bytes) {
  const SteadyTime deadline = SystemClock{}.Steady() + kPatience;
  while (received_.size() < bytes.size()) {
    UPLINK_CHECK(tcp_.end() == RawTcp::End::kNone, "the broker ended a publisher");
    UPLINK_CHECK(tcp_.Wait(RawTcp::For::kInput, deadline), "the broker answers a publisher");
    received_ += tcp_.Receive();
  }
  UPLINK_CHECK(received_.starts_with(bytes), "the broker's answer");
  received_.erase(0, bytes.size());
}

}  // namespace uplink::testing
