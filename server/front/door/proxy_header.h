#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <sys/socket.h>

namespace uplink::front {

/// What a load balancer says of a connection before the peer's own first byte: a PROXY protocol
/// header of version 2, read piece by piece.
///
/// It wants the fixed part first, and then exactly as many bytes as that announces, so that nothing
/// of the peer's is ever read. What follows the addresses (type, length, value) is skipped, its
/// checksum too.
/// Limits:  kRestBytesMax.
/// Thread:  confined to whoever has it.
/// Source:  HAProxy's proxy-protocol.txt, section 2.2.
class ProxyHeader final {
 public:
  static constexpr std::size_t kFixedBytes = 16;
  /// Bytes that may follow the fixed part: the specification means a header to fit into one
  /// segment, and 536 bytes is what each network takes.
  static constexpr std::size_t kRestBytesMax = 536;

  enum class Result : std::uint8_t {
    /// It is not whole.
    kMore,
    /// Relayed for source().
    kRelayed,
    /// Relayed for somebody whose address is not told (UNSPEC).
    kUntold,
    /// The load balancer came on its own account (LOCAL), mostly to see whether we answer.
    kLocal,
    /// No header of version 2, or one for what cannot come here: datagrams, local sockets, families
    /// and commands that the specification does not have, less bytes than the addresses take.
    kInvalid,
  };

  /// Bytes that are to come next; none once the result is known.
  [[nodiscard]] std::size_t wanted() const {
    return result_ == Result::kMore ? bytes_ - taken_ : 0;
  }
  /// Takes the next bytes, at most those that are wanted.
  Result Take(std::string_view bytes);
  [[nodiscard]] Result result() const { return result_; }
  /// Bytes came.
  [[nodiscard]] bool begun() const { return taken_ > 0; }
  /// Address and port of whom the connection was relayed for.
  [[nodiscard]] const sockaddr_storage& source() const { return source_; }

 private:
  static constexpr std::size_t kIpv4Bytes = 12;
  static constexpr std::size_t kIpv6Bytes = 36;
  enum class Family : std::uint8_t { kNone, kIpv4, kIpv6 };

  [[nodiscard]] Result Judge();
  /// The fixed part is there.
  [[nodiscard]] bool JudgeFixed();
  void SetSource();

  Result result_ = Result::kMore;
  /// What it ends in, once it is whole.
  Result whole_ = Result::kMore;
  Family family_ = Family::kNone;
  /// Of the header, as far as is known.
  std::size_t bytes_ = kFixedBytes;
  std::size_t taken_ = 0;
  /// Its beginning: what follows is not looked at.
  std::array<std::uint8_t, kFixedBytes + kIpv6Bytes> kept_{};
  sockaddr_storage source_{};
};

/// What a load balancer says before it asks on its own account.
inline constexpr std::string_view kLocalProxyHeader("\r\n\r\n\0\r\nQUIT\n\x20\0\0\0",
                                                    ProxyHeader::kFixedBytes);

}  // namespace uplink::front
