#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::bench {

/// A PUBLISH of MQTT 3.1.1 that is made once and sent many times. A value.
struct PublishPacket {
  std::string bytes;
  /// Where its packet id stands, which each sending has anew; 0 at QoS 0, which has none.
  std::size_t id_at = 0;

  void SetId(std::uint16_t id);
};

[[nodiscard]] PublishPacket LivePacket(std::string_view topic, std::string_view payload);
/// The same at QoS 1, with packet id 0.
[[nodiscard]] PublishPacket DurablePacket(std::string_view topic, std::string_view payload);

/// The id of a twin of the benchmark.
[[nodiscard]] std::string TwinId(std::size_t twin);

/// Joints of an arm of six, flat, as the vendor's client publishes them; `step` moves them.
[[nodiscard]] std::string FlatJoints(std::size_t step);
/// An event; `step` makes it another one.
[[nodiscard]] std::string EventText(std::size_t step);

/// Packets of so many twins, `steps` of each, twin after twin: the packet at i is twin i % twins'.
[[nodiscard]] std::vector<PublishPacket> JointPackets(std::size_t twins, std::size_t steps);
[[nodiscard]] std::vector<PublishPacket> EventPackets(std::size_t twins, std::size_t steps);
/// One depth frame of so many bytes.
[[nodiscard]] std::vector<PublishPacket> DepthPackets(std::size_t bytes);

}  // namespace uplink::bench
