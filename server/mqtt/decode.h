#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// A packet's first byte and remaining length.
struct Opening {
  std::uint8_t first = 0;
  std::uint32_t remaining = 0;

  [[nodiscard]] bool is_publish() const {
    return first >> 4U == static_cast<unsigned>(PacketType::kPublish);
  }
  [[nodiscard]] Qos qos() const {
    return (first & 0x06U) == 0 ? Qos::kAtMostOnce : Qos::kAtLeastOnce;
  }
};

/// What is wrong with a packet by its opening alone: a type that no broker sends to a subscriber,
/// flags that it cannot have, QoS 2, an answer over kAnswerBytesMax. Nothing if it may be read on.
[[nodiscard]] std::optional<Fault> CheckOpening(Version version, const Opening& opening);

/// How far a PUBLISH's head (all before its payload) reaches, as its first bytes tell.
struct HeadExtent {
  /// Bytes of the head if `known`, else those that are needed to know more; never past the packet.
  std::size_t bytes = 0;
  bool known = false;
  /// It is over kHeadBytesMax by its properties: `bytes` ends before these, and nothing behind that
  /// is to be kept.
  bool too_large = false;
};
/// `begin`: the packet's bytes behind the opening, as far as they are there.
///
/// Errors: kMalformed if it would end past the packet.
[[nodiscard]] Decoded<HeadExtent> ExtentOfHead(Version version, const Opening& opening,
                                               std::string_view begin);

/// A PUBLISH from its head, of which `extent` is known. The caller sets the payload.
///
/// What its publisher chose is no error: a topic may be none (Publish::bad_topic), and a head too
/// large (Publish::head_unread).
[[nodiscard]] Decoded<Publish> DecodePublishHead(Version version, const Opening& opening,
                                                 const HeadExtent& extent, std::string_view head);

/// Any other packet, whose opening passed CheckOpening, from all that follows it.
[[nodiscard]] Decoded<Packet> DecodeAnswer(Version version, const Opening& opening,
                                           std::string_view body);

// Thread:  pure; any thread. No input makes these abort.
// Source:  MQTT 3.1.1 and 5.0 (OASIS), chapter 3; what [MQTT-...] names is a rule there.

}  // namespace uplink::mqtt
