#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "server/mqtt/decode.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// Packets out of the bytes of a connection, however these are cut.
///
/// A packet that lies whole in the bytes is read where it lies; of one that does not, the beginning
/// is kept until the rest comes. A PUBLISH whose payload is over `payload_bytes_max` is read past:
/// its head is kept, of its payload the size alone. If its head is over kHeadBytesMax, its topic
/// and id are kept, and the size of all.
///
/// Errors:  what is found once is found again; a connection that is broken stays so.
/// Limits:  kHeadBytesMax, kAnswerBytesMax and `payload_bytes_max` bound what is kept.
/// Thread:  confined to its connection's.
class Wire final {
 public:
  /// `payload_bytes_max`: bytes of the largest payload that is wanted.
  Wire(Version version, std::size_t payload_bytes_max)
      : version_(version), payload_bytes_max_(payload_bytes_max) {}

  /// All bytes were taken, and more are needed.
  struct More {};
  /// A packet begins, and has its opening: whoever has no room for one says so by taking no more.
  struct Opened {
    bool is_qos1 = false;
  };
  struct Step {
    /// Of the bytes that were given.
    std::size_t taken = 0;
    /// A Packet's views are into those bytes, or hold until the next call.
    std::variant<More, Opened, Packet, Fault> found;
  };
  /// Takes bytes up to the next thing that is found. After Opened it must be called again even with
  /// no bytes: there are packets without any.
  [[nodiscard]] Step Take(std::string_view bytes);

  /// Bytes that are kept of a packet which is not whole.
  [[nodiscard]] std::size_t kept_bytes() const { return kept_.size(); }

 private:
  enum class Part : std::uint8_t {
    kFirst,   // its first byte
    kLength,  // the digits of its remaining length
    kHead,    // a PUBLISH up to its payload, not whole in the bytes that were given
    kBody,    // up to its end, to be kept until then
    kPast,    // what is not wanted, behind the head or what is kept of it
    kBroken,
  };

  Step TakeOpening(std::string_view bytes);
  Step TakeRest(std::string_view bytes);
  Step TakeHead(std::string_view bytes, std::size_t before);
  Step TakeBody(std::string_view bytes, std::size_t before);
  Step TakePast(std::string_view bytes, std::size_t before);
  /// The packet is whole; `rest` is all that follows its opening.
  Step Whole(std::string_view rest, std::size_t taken);
  /// `rest` has the whole head, and the payload behind it if that is wanted.
  Step WholePublish(std::string_view rest, const HeadExtent& head, std::size_t taken);
  [[nodiscard]] bool IsWanted(const HeadExtent& head) const;
  Step Break(const Fault& fault, std::size_t taken);

  const Version version_;
  const std::size_t payload_bytes_max_;
  Part part_ = Part::kFirst;
  Opening opening_;
  std::size_t digits_ = 0;
  /// The packet before it was given out: `kept_` is of no use any more.
  bool given_ = false;
  std::string kept_;
  HeadExtent head_;
  std::size_t past_bytes_ = 0;
  Fault fault_;
};

}  // namespace uplink::mqtt
