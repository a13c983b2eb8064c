#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <sys/socket.h>

namespace uplink::front {

/// A PROXY protocol header of version 2, which a load balancer sends before the peer's first byte;
/// read piece by piece.
///
/// It reads the fixed part, then exactly as many bytes as that announces, so it never reads the
/// peer's bytes. It skips what follows the addresses (type, length, value), checksum included.
/// Limits:  kRestBytesMax.
/// Thread:  confined to its owner's.
/// Source:  HAProxy's proxy-protocol.txt, section 2.2.
class ProxyHeader final {
 public:
  static constexpr std::size_t kFixedBytes = 16;
  /// Bytes that may follow the fixed part: the specification wants a header to fit into one
  /// segment, and every network takes 536 bytes.
  static constexpr std::size_t kRestBytesMax = 536;

  enum class Result : std::uint8_t {
    /// The header is incomplete.
    kMore,
    /// Relayed for source().
    kRelayed,
    /// Relayed for a peer whose address is not told (UNSPEC).
    kUntold,
    /// The load balancer came on its own account (LOCAL), mostly to see whether we answer.
    kLocal,
    /// No header of version 2, or one that cannot be right here: for datagrams, local sockets,
    /// unknown families or commands, or with fewer bytes than the addresses take.
    kInvalid,
  };

  /// Bytes to read next; 0 once the result is known.
  [[nodiscard]] std::size_t wanted() const {
    return result_ == Result::kMore ? bytes_ - taken_ : 0;
  }
  /// Takes the next bytes, at most wanted().
  Result Take(std::string_view bytes);
  [[nodiscard]] Result result() const { return result_; }
  /// Bytes came.
  [[nodiscard]] bool begun() const { return taken_ > 0; }
  /// Address and port of the peer.
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
  /// The result once the header is complete.
  Result whole_ = Result::kMore;
  Family family_ = Family::kNone;
  /// Bytes of the header that are known to belong to it; more once the fixed part announces them.
  std::size_t bytes_ = kFixedBytes;
  std::size_t taken_ = 0;
  /// The part that is looked at.
  std::array<std::uint8_t, kFixedBytes + kIpv6Bytes> kept_{};
  sockaddr_storage source_{};
};

/// The header that a load balancer sends when it checks us on its own account.
inline constexpr std::string_view kLocalProxyHeader("\r\n\r\n\0\r\nQUIT\n\x20\0\0\0",
                                                    ProxyHeader::kFixedBytes);

}  // namespace uplink::front
