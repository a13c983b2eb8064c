#include "server/health/certificate.h"

#include "server/identity/server_pair.h"

namespace uplink::health {

absl::StatusOr<CertificateLook> LookAtCertificate(const std::string& certificate_file,
                                                  const std::string& key_file) {
  const auto certificate = identity::ReadPem(certificate_file);
  if (!certificate.ok()) return certificate.status();
  const auto expiry = identity::ExpiryOf(*certificate);
  if (!expiry.ok()) return expiry.status();
  const auto key = identity::ReadPem(key_file);
  return CertificateLook{*expiry,
                         key.ok() ? identity::CheckServerPair(*certificate, *key) : key.status()};
}

}  // namespace uplink::health
