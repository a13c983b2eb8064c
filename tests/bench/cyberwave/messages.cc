#include "tests/bench/cyberwave/messages.h"

#include <cmath>

#include <fmt/core.h>

#include "tests/bench/load/mqtt.h"

namespace uplink::bench {
namespace {

constexpr unsigned kByteBits = 8;
constexpr std::uint16_t kIdUnset = 0;
/// Between two steps of an arm, in seconds.
constexpr double kStepSeconds = 0.025;
constexpr int kJoints = 6;

std::string TwinTopic(std::size_t twin, std::string_view tail) {
  return fmt::format("cyberwave/twin/{}/{}", TwinId(twin), tail);
}

PublishPacket Whole(char head, const std::string& body, std::size_t id_in_body) {
  PublishPacket packet{.bytes = std::string(1, head)};
  AppendMqttLength(packet.bytes, body.size());
  if (id_in_body > 0) packet.id_at = packet.bytes.size() + id_in_body;
  packet.bytes += body;
  return packet;
}

}  // namespace

void PublishPacket::SetId(std::uint16_t id) {
  bytes[id_at] = static_cast<char>(id >> kByteBits);
  bytes[id_at + 1] = static_cast<char>(id);
}

PublishPacket LivePacket(std::string_view topic, std::string_view payload) {
  std::string body;
  AppendMqttText(body, topic);
  body.append(payload);
  return Whole(kMqttPublish, body, 0);
}

PublishPacket DurablePacket(std::string_view topic, std::string_view payload) {
  std::string body;
  AppendMqttText(body, topic);
  const std::size_t id_in_body = body.size();
  AppendMqttNumber(body, kIdUnset);
  body.append(payload);
  return Whole(kMqttPublishQos1, body, id_in_body);
}

std::string TwinId(std::size_t twin) {
  return fmt::format("b0000000-0000-4000-8000-{:012x}", twin);
}

std::string FlatJoints(std::size_t step) {
  const double seconds = static_cast<double>(step) * kStepSeconds;
  std::string text = R"({"source_type": "edge")";
  for (int joint = 1; joint <= kJoints; ++joint) {
    text += fmt::format(R"(, "_{}": {:.6f})", joint, std::sin(seconds + joint));
  }
  // Such messages have no time of their own.
  return text + R"(, "session_id": "python-sdk_live_5d5d5d5d5d5d4d5d8d5d5d5d5d5d5d5d"})";
}

std::string EventText(std::size_t step) {
  return fmt::format(
      R"({{"event_type":"inspection","source":"benchmark","data":{{"part":"part-{}","result":"good","score":0.{:03}}}}})",
      step, step % 1000);
}

std::vector<PublishPacket> JointPackets(std::size_t twins, std::size_t steps) {
  std::vector<PublishPacket> packets;
  packets.reserve(twins * steps);
  for (std::size_t step = 0; step < steps; ++step) {
    const std::string payload = FlatJoints(step);
    for (std::size_t twin = 0; twin < twins; ++twin) {
      packets.push_back(
          LivePacket(fmt::format("cyberwave/joint/{}/update", TwinId(twin)), payload));
    }
  }
  return packets;
}

std::vector<PublishPacket> EventPackets(std::size_t twins, std::size_t steps) {
  std::vector<PublishPacket> packets;
  packets.reserve(twins * steps);
  for (std::size_t step = 0; step < steps; ++step) {
    const std::string payload = EventText(step);
    for (std::size_t twin = 0; twin < twins; ++twin) {
      packets.push_back(DurablePacket(TwinTopic(twin, "event"), payload));
    }
  }
  return packets;
}

std::vector<PublishPacket> DepthPackets(std::size_t bytes) {
  return {LivePacket(TwinTopic(0, "depth"), std::string(bytes, '\x5A'))};
}

}  // namespace uplink::bench
