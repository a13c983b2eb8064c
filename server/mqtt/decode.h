#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// A packet's first byte and remaining length.
struct FixedHeader {
  std::uint8_t first = 0;
  std::uint32_t remaining = 0;

  [[nodiscard]] bool is_publish() const {
    return first >> 4U == static_cast<unsigned>(PacketType::kPublish);
  }
  [[nodiscard]] Qos qos() const {
    return (first & 0x06U) == 0 ? Qos::kAtMostOnce : Qos::kAtLeastOnce;
  }
};

/// What is wrong with a packet by its fixed header alone: a type that no broker sends to a
/// subscriber, invalid flags, QoS 2, or an answer over kAnswerBytesMax. Empty if it may be read on.
[[nodiscard]] std::optional<Fault> CheckFixedHeader(Version version, const FixedHeader& fixed);

/// The extent of a PUBLISH's head (everything before its payload), by its first bytes.
struct HeadExtent {
  /// Bytes of the head if `known`, otherwise bytes needed to know more; never past the packet.
  std::size_t bytes = 0;
  bool known = false;
  /// Its properties make it larger than kHeadBytesMax: `bytes` ends before them, and nothing after
  /// that must be kept.
  bool too_large = false;
};
/// `begin`: those bytes of the packet after the fixed header that have arrived.
///
/// Errors: kMalformed if it would end past the packet.
[[nodiscard]] Decoded<HeadExtent> ExtentOfHead(Version version, const FixedHeader& fixed,
                                               std::string_view begin);

/// Decodes a PUBLISH from its head, whose `extent` is known. The caller sets the payload.
///
/// Its publisher's choices are no errors: the topic may be invalid (Publish::bad_topic), and the
/// head too large (Publish::head_unread).
[[nodiscard]] Decoded<Publish> DecodePublishHead(Version version, const FixedHeader& fixed,
                                                 const HeadExtent& extent, std::string_view head);

/// Decodes any other packet, whose fixed header passed CheckFixedHeader, from everything after it.
[[nodiscard]] Decoded<Packet> DecodeAnswer(Version version, const FixedHeader& fixed,
                                           std::string_view body);

// Thread:  pure; any thread. No input makes these abort.
// Source:  MQTT 3.1.1 and 5.0 (OASIS), chapter 3; what [MQTT-...] names is a rule there.

}  // namespace uplink::mqtt
