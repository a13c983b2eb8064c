#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <openssl/types.h>

#include "schema/base/clock.h"
#include "storage/connection.h"

namespace uplink::identity {

/// What tells one client certificate from others. It takes less memory than its texts, since each
/// connection has one. A value.
struct ShownCertificate {
  using Sha256 = std::array<std::uint8_t, 32>;

  /// Hexadecimal, in upper case; empty: no certificate.
  std::string serial = {};
  /// Of the certificate (DER), and of its public key: SPKI in DER as OpenSSL writes it, so that a
  /// key has one digest however a certificate writes it.
  Sha256 sha256{};
  Sha256 key_sha256{};
  SystemTime not_after{};
};

/// A certificate by its serial number and the key that signed it: authorities may share a name, and
/// have keys of their own. A value.
struct SignedSerial {
  /// As ShownCertificate::serial.
  std::string serial;
  /// As ShownCertificate::key_sha256, of the authority.
  ShownCertificate::Sha256 signer{};

  friend bool operator==(const SignedSerial&, const SignedSerial&) = default;
};

/// Bytes of a serial number's text that are kept: 20 bytes (RFC 5280), and as many again of
/// certificates that do not keep to that.
inline constexpr std::size_t kSerialTextBytesMax = 80;

/// The facts of a certificate. Computes two digests, some microseconds.
[[nodiscard]] ShownCertificate ShownBy(const X509& certificate);
/// As ShownCertificate::sha256, and key_sha256.
[[nodiscard]] ShownCertificate::Sha256 DigestOf(const X509& certificate);
[[nodiscard]] ShownCertificate::Sha256 KeyDigestOf(const X509& certificate);
/// The issuer as `openssl x509 -issuer -nameopt RFC2253` writes it; empty if it cannot be written.
[[nodiscard]] std::string IssuerOf(const X509& certificate);
/// A name in the same form.
[[nodiscard]] std::string NameOf(const X509_NAME& name);
/// As CRLs and certificates have it, in the form of ShownCertificate::serial.
[[nodiscard]] std::string SerialText(const ASN1_INTEGER& serial);
/// As texts, as lists of connections have them.
[[nodiscard]] storage::CertificateFacts FactsOf(const ShownCertificate& certificate);

/// The end of the certificate's life; the epoch if it cannot be read.
[[nodiscard]] SystemTime NotAfterOf(const X509& certificate);

}  // namespace uplink::identity
