#include "server/health/certificate.h"

#include "server/identity/expiry.h"
#include "server/identity/pem_file.h"

namespace uplink::health {

absl::StatusOr<SystemTime> CertificateExpiry(const std::string& pem_file) {
  const auto certificate = identity::ReadPem(pem_file);
  if (!certificate.ok()) return certificate.status();
  return identity::ExpiryOf(*certificate);
}

}  // namespace uplink::health
