#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Certificates byte by byte: of every kind of key, and of kinds that no robot should have. They are
// not signed, and their private keys do not exist.
namespace uplink::testing::odd {

/// A SubjectPublicKeyInfo of this algorithm: its identifier with parameters, and the key's bits.
[[nodiscard]] std::string KeyOf(std::string_view algorithm, std::string_view key);

enum class Curve { kP256, kP384, kP521 };
enum class Point { kCompressed, kUncompressed };
/// A point of the named curve.
[[nodiscard]] std::string NamedCurveKey(Curve curve, Point form);
/// A curve that is written out, over the prime 97 * 2^652 + 1, whose generator and point are
/// compressed: OpenSSL 3.0 takes about 260 ms to read it.
[[nodiscard]] std::string ExplicitCurveKey();
/// A modulus and a public exponent of so many bits.
[[nodiscard]] std::string RsaKey(std::size_t modulus_bits, std::size_t exponent_bits);
/// The same, as RSA-PSS without parameters.
[[nodiscard]] std::string RsaPssKey(std::size_t modulus_bits, std::size_t exponent_bits);
[[nodiscard]] std::string Ed25519Key();
[[nodiscard]] std::string Ed448Key();

/// A name with a common name, in DER.
[[nodiscard]] std::string NameOf(std::string_view common_name);
/// An extension that is not critical, by the encoded content of its identifier.
[[nodiscard]] std::string Extension(std::string_view oid, std::string_view value);

/// The parts of a certificate, in DER.
struct Parts {
  std::string version = std::string("\xA0\x03\x02\x01\x02", 5);
  std::string issuer = NameOf("an authority");
  std::string subject = NameOf("a robot");
  std::string key;
  /// GeneralizedTime's text.
  std::string not_after = "20991231235959Z";
  /// Elements one after the other; empty: there are none.
  std::string extensions;
  /// Behind everything else of what is signed.
  std::string tail;
};

[[nodiscard]] std::string CertificateOf(const Parts& parts);
/// A certificate with this key.
[[nodiscard]] std::string CertificateWith(const std::string& key);

/// The body of a Certificate message that shows these.
[[nodiscard]] std::string MessageOf12(const std::vector<std::string>& certificates);
[[nodiscard]] std::string MessageOf13(const std::vector<std::string>& certificates);

/// What may stand behind a client's own certificate and takes OpenSSL the most time: as many
/// certificates as may come, with compressed points of P-521, and as many names as may come.
[[nodiscard]] std::vector<std::string> DearChain();

/// One certificate, or another block of this label, as a PEM text.
[[nodiscard]] std::string PemOf(const std::string& certificate,
                                const std::string& label = "CERTIFICATE");
/// Of a PEM text, each certificate in DER.
[[nodiscard]] std::vector<std::string> DerOf(std::string_view pem);

}  // namespace uplink::testing::odd
