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

/// What no robot may show, no authority may have either: it could show it as part of its chain. Nor
/// a key that makes strangers of all its robots.
std::string FlawOf(X509* certificate) {
  // Without what a TRUSTED CERTIFICATE has behind it.
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
