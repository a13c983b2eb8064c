#include "server/identity/expiry.h"

#include <cstdint>
#include <ctime>

#include <fmt/core.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"

namespace uplink::identity {

absl::StatusOr<SystemTime> ExpiryOf(const NamedPem& certificate) {
  const auto certificates = ReadCertificates(certificate);
  if (!certificates.ok()) return certificates.status();
  std::tm utc{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(certificates->front().get()), &utc) != 1) {
    return absl::FailedPreconditionError(
        fmt::format("{}: holds no time of expiry", certificate.name));
  }
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

}  // namespace uplink::identity
