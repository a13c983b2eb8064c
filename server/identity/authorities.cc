#include "server/identity/authorities.h"

#include <cstddef>
#include <string>

#include <fmt/core.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/x509.h>

#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"
#include "server/identity/strength.h"

namespace uplink::identity {
namespace {

/// An authority's certificate must be one that a robot may show, because a robot may show it as
/// part of its chain. Its key must not be so weak that all its robots would be refused.
std::string FlawOf(X509* certificate) {
  // Without the notes at the end of a TRUSTED CERTIFICATE.
  unsigned char* bytes = nullptr;
  const int size = i2d_X509(certificate, &bytes);
  ERR_clear_error();
  if (size <= 0) return "is broken: it is no certificate that can be read";
  const CertificateFlaw flaw = FlawOfCertificate({bytes, static_cast<std::size_t>(size)});
  OPENSSL_free(bytes);
  if (flaw != CertificateFlaw::kNone) return fmt::format("cannot be used: {}", TextOf(flaw));
  const std::string weakness = WeaknessOf(*certificate);
  return weakness.empty() ? weakness : "cannot be used: " + weakness;
}

}  // namespace

absl::Status CheckAuthorities(const NamedPem& authorities) {
  return ReadCertificates(authorities, FlawOf).status();
}

}  // namespace uplink::identity
