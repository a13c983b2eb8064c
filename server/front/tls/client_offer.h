#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <openssl/types.h>

#include "server/transport/options.h"

namespace uplink::front {

/// What a client and we must agree on in a handshake.
enum class Agreed : std::uint8_t { kVersion, kSuite, kGroup, kSignature, kProtocol };

/// The part of a ClientHello's offer that the log names. A value.
class ClientOffer final {
 public:
  ClientOffer() = default;
  /// From within OpenSSL's callback for a ClientHello.
  explicit ClientOffer(SSL* connection);

  /// Why they do not agree: what the client offers, and what we accept.
  ///
  /// Limits: kNamedMax of each list, kProtocolBytesMax of protocols; some 500 bytes in all.
  [[nodiscard]] std::string WhyNot(Agreed what, SSL* connection,
                                   const transport::TlsRules& rules) const;

 private:
  static constexpr std::size_t kNamedMax = 8;
  static constexpr std::size_t kProtocolBytesMax = 64;

  /// The first numbers of a list, and its length, without the reserved ones that servers must
  /// ignore (GREASE).
  struct Numbers {
    void Add(std::uint16_t number);
    /// Adds a TLS list, which follows a length of so many bytes.
    void AddList(std::string_view bytes, std::size_t length_bytes);

    std::array<std::uint16_t, kNamedMax> first{};
    std::size_t count = 0;
  };
  /// The numbers by name.
  [[nodiscard]] static std::string TextOf(const Numbers& numbers,
                                          std::string (*name)(std::uint16_t, SSL*),
                                          SSL* connection);
  [[nodiscard]] std::string ProtocolsText() const;

  Numbers versions_;
  Numbers suites_;
  Numbers groups_;
  Numbers signatures_;
  /// The first bytes of the ALPN list.
  std::array<char, kProtocolBytesMax> protocols_{};
  std::size_t protocol_bytes_ = 0;
};

}  // namespace uplink::front
