#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "server/identity/der_reader.h"

namespace uplink::identity {

/// Certificates of one message: a robot's, an authority's, and eight between them.
inline constexpr std::size_t kShownCertificatesMax = 10;
/// Bytes of the message's body: a gateway's certificate may name 256 robots.
inline constexpr std::size_t kShownBytesMax = std::size_t{32} * 1024;
/// Elements of DER in the names and extensions of all certificates of a message. OpenSSL takes up
/// to a microsecond for each, before it knows who signed it. A robot's certificate has about 60, a
/// gateway's with 256 names about 320.
inline constexpr std::size_t kShownElementsMax = 2048;

/// What is wrong with certificates that a peer shows. Closed.
enum class CertificateFlaw : std::uint8_t {
  kNone,
  /// Not a certificate by DER's rules, or not a Certificate message.
  kMalformed,
  /// More than kShownCertificatesMax.
  kCount,
  /// More bytes than kShownBytesMax.
  kBytes,
  /// More elements than kShownElementsMax.
  kElements,
  /// A kind of key that we do not accept (FlawOfKey).
  kKeyKind,
  /// An RSA key that is longer than we accept.
  kKeySize,
  /// A CRL distribution point with a name relative to its issuer's: OpenSSL copies the issuer's
  /// name for each.
  kRelativePoint,
};

/// Text for the log; empty for kNone.
[[nodiscard]] std::string_view TextOf(CertificateFlaw flaw);

/// Judges a whole certificate in DER, before OpenSSL reads it. It reads all of it, so that OpenSSL
/// cannot find another key in it than the one that was judged. It does not judge what the dates,
/// the names and the signature say.
///
/// Thread: pure; any thread. Nothing is allocated. Time: linear in the bytes.
/// Source: RFC 5280, 4.1.
[[nodiscard]] CertificateFlaw FlawOfCertificate(Bytes certificate);

/// The form of a Certificate message.
enum class MessageForm : std::uint8_t {
  kTls12,
  /// With a context, which is empty unless a client is asked after the handshake, and with
  /// extensions for each certificate, which a peer may send only if asked: we ask for none.
  kTls13,
};

/// Judges the body of a Certificate message. One without certificates has no flaw.
///
/// Source: RFC 5246, 7.4.2; RFC 8446, 4.4.2.
[[nodiscard]] CertificateFlaw FlawOfMessage(MessageForm form, Bytes body);

}  // namespace uplink::identity
