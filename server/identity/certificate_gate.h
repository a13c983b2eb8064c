#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "server/identity/der_reader.h"

namespace uplink::identity {

/// Certificates of one message: a robot's, and eight between it and an authority's, which may come
/// too.
inline constexpr std::size_t kShownCertificatesMax = 10;
/// Bytes of the message's body: a gateway's certificate may name 256 robots.
inline constexpr std::size_t kShownBytesMax = std::size_t{32} * 1024;
/// Elements of DER in names and extensions of all certificates of a message: OpenSSL takes up to a
/// microsecond for one of them, before it knows who signed it. A robot's certificate has about 60,
/// a gateway's with 256 names about 320.
inline constexpr std::size_t kShownElementsMax = 2048;

/// What is wrong with certificates that somebody shows. Closed.
enum class CertificateFlaw : std::uint8_t {
  kNone,
  /// No certificate by DER's rules, or no Certificate message.
  kMalformed,
  /// More than kShownCertificatesMax.
  kCount,
  /// More bytes than kShownBytesMax.
  kBytes,
  /// More elements than kShownElementsMax.
  kElements,
  /// A kind of key that is not taken (FlawOfKey).
  kKeyKind,
  /// A longer RSA key than is taken.
  kKeySize,
  /// A CRL distribution point whose name is relative to its issuer's, for which OpenSSL copies that
  /// name.
  kRelativePoint,
};

/// For lines of the log; empty for kNone.
[[nodiscard]] std::string_view TextOf(CertificateFlaw flaw);

/// Judges a whole certificate in DER, before OpenSSL reads it. It goes through all of it, so that
/// OpenSSL finds no other key in it than the one that was judged. What it says of dates, names and
/// signature is not judged.
///
/// Thread: pure; any thread. Nothing is allocated. Time: linear in the bytes.
/// Source: RFC 5280, 4.1.
[[nodiscard]] CertificateFlaw FlawOfCertificate(Bytes certificate);

/// How certificates stand in a Certificate message.
enum class MessageForm : std::uint8_t {
  kTls12,
  /// With a context, which is empty unless a client is asked after the handshake, and with
  /// extensions of each, which a peer may have only if it was asked for them: we ask for none.
  kTls13,
};

/// The same of the body of a Certificate message. One without certificates has no flaw.
///
/// Source: RFC 5246, 7.4.2; RFC 8446, 4.4.2.
[[nodiscard]] CertificateFlaw FlawOfMessage(MessageForm form, Bytes body);

}  // namespace uplink::identity
