#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "server/mqtt/byte_reader.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// What we use of a packet's properties. Views are into the packet.
struct Properties {
  std::optional<std::uint16_t> server_keepalive_seconds;
  std::optional<std::uint32_t> session_expiry_seconds;
  std::optional<std::uint32_t> packet_bytes_max;
  std::string_view reason;
  /// Of any length that fits.
  std::string_view correlation;
  bool has_response_topic = false;
};

/// Reads the properties of one packet of MQTT 5, its length of them first.
///
/// Each must be one that MQTT 5 has, so that its length is known. In an answer it must also be one
/// that this packet may have, once (user properties: any number), with a value that it may take,
/// texts in UTF-8. Those of a PUBLISH come from its publisher, whom a broker may let say anything:
/// they are passed over by their lengths and not judged, and of one that stands twice the last
/// counts. Of what we do not use nothing is kept.
///
/// Errors:  kUnknownProperty, kTopicAlias (we announced that there are none), else kMalformed.
/// Limits:  those of the packet, which is whole.
/// Thread:  pure; any thread.
/// Source:  MQTT 5.0, table 2-4.
[[nodiscard]] Decoded<Properties> ReadProperties(PacketType packet, ByteReader& from);

}  // namespace uplink::mqtt
