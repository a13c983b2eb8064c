#pragma once

#include <cstddef>
#include <cstdint>

#include "server/identity/der_reader.h"

namespace uplink::identity {

/// The most bits of an RSA key's modulus, and of its public exponent.
inline constexpr std::size_t kRsaBitsMax = 4096;
inline constexpr std::size_t kRsaExponentBitsMax = 64;

/// What is wrong with a public key. Closed.
enum class KeyFlaw : std::uint8_t {
  kNone,
  /// It is not DER, or not as its kind of key should be.
  kMalformed,
  /// A kind of key or a curve that we do not accept, or a curve that is written out.
  kKind,
  /// An RSA key with a longer modulus or exponent.
  kSize,
};

/// Judges the content of a SubjectPublicKeyInfo before OpenSSL decodes it: a curve that is written
/// out costs OpenSSL 3.0 a quarter of a second, and verifying with a long RSA key or exponent is
/// slow. Accepted are points of the named curves P-256, P-384 and P-521, compressed or not;
/// Ed25519 and Ed448; RSA and RSA-PSS up to kRsaBitsMax and kRsaExponentBitsMax.
///
/// It does not check that a point is on its curve: OpenSSL does.
/// Thread: pure; any thread. Time: some hundred nanoseconds.
/// Source: RFC 5280, 4.1.2.7; RFC 5480, 2; RFC 8017, A.1; RFC 8410, 3 and 4; RFC 4055, 1.2 and 3.1.
[[nodiscard]] KeyFlaw FlawOfKey(Bytes info);

}  // namespace uplink::identity
