#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "server/mqtt/byte_reader.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// The properties of a packet that we use. Views are into the packet.
struct Properties {
  std::optional<std::uint16_t> server_keepalive_seconds;
  std::optional<std::uint32_t> session_expiry_seconds;
  std::optional<std::uint32_t> packet_bytes_max;
  std::string_view reason;
  /// Of any length that fits.
  std::string_view correlation;
  bool has_response_topic = false;
};

/// Reads the properties of one packet of MQTT 5, beginning with their length.
///
/// Each must be a property of MQTT 5, so that its length is known. In an answer it must also be
/// allowed in that packet, appear once (except user properties), and have a valid value, with texts
/// in UTF-8. Those of a PUBLISH come from its publisher, and a broker may pass anything on: they
/// are skipped by their lengths and not checked, and the last of a repeated one counts. Properties
/// that we do not use are not kept.
///
/// Errors:  kUnknownProperty, kTopicAlias (we announced that there are none), otherwise kMalformed.
/// Limits:  those of the packet, which is whole.
/// Thread:  pure; any thread.
/// Source:  MQTT 5.0, table 2-4.
[[nodiscard]] Decoded<Properties> ReadProperties(PacketType packet, ByteReader& from);

}  // namespace uplink::mqtt
