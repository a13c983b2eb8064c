#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "server/mqtt/decode.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// Cuts packets out of the bytes of a connection, whose pieces may end anywhere.
///
/// A packet that is complete in the given bytes is read in place; otherwise its beginning is kept
/// until the rest comes. A PUBLISH with a payload over `payload_bytes_max` is skipped: its head and
/// the payload's size are kept. If its head is over kHeadBytesMax, only topic, id and the whole
/// size are kept.
///
/// Errors:  a fault is final: each later call returns it again.
/// Limits:  kHeadBytesMax, kAnswerBytesMax and `payload_bytes_max` bound what is kept.
/// Thread:  confined to its connection's.
class Wire final {
 public:
  /// `payload_bytes_max`: bytes of the largest payload that is wanted.
  Wire(Version version, std::size_t payload_bytes_max)
      : version_(version), payload_bytes_max_(payload_bytes_max) {}

  /// All bytes were taken, and more are needed.
  struct More {};
  /// A packet begins, and its fixed header is complete: a caller without room for it takes no more.
  struct Opened {
    bool is_qos1 = false;
  };
  struct Step {
    /// How many of the given bytes were taken.
    std::size_t taken = 0;
    /// A Packet's views are into those bytes, or valid until the next call.
    std::variant<More, Opened, Packet, Fault> found;
  };
  /// Takes bytes up to the next finding. After Opened call it again even without bytes, since some
  /// packets have none.
  [[nodiscard]] Step Take(std::string_view bytes);

  /// Bytes kept of an incomplete packet.
  [[nodiscard]] std::size_t kept_bytes() const { return kept_.size(); }

 private:
  enum class Part : std::uint8_t {
    kFirst,   // its first byte
    kLength,  // the digits of its remaining length
    kHead,    // a PUBLISH up to its payload, not whole in the bytes that were given
    kBody,    // up to its end; kept until then
    kPast,    // unwanted bytes behind the part of the head that is kept
    kBroken,
  };

  Step TakeFixedHeader(std::string_view bytes);
  Step TakeRest(std::string_view bytes);
  Step TakeHead(std::string_view bytes, std::size_t before);
  Step TakeBody(std::string_view bytes, std::size_t before);
  Step TakePast(std::string_view bytes, std::size_t before);
  /// The packet is complete; `rest` is everything after its fixed header.
  Step Whole(std::string_view rest, std::size_t taken);
  /// `rest` has the complete head, and the payload after it if that is wanted.
  Step WholePublish(std::string_view rest, const HeadExtent& head, std::size_t taken);
  [[nodiscard]] bool IsWanted(const HeadExtent& head) const;
  Step Break(const Fault& fault, std::size_t taken);

  const Version version_;
  const std::size_t payload_bytes_max_;
  Part part_ = Part::kFirst;
  FixedHeader fixed_;
  std::size_t digits_ = 0;
  /// The previous packet was given out, so `kept_` is free.
  bool given_ = false;
  std::string kept_;
  HeadExtent head_;
  std::size_t past_bytes_ = 0;
  Fault fault_;
};

}  // namespace uplink::mqtt
