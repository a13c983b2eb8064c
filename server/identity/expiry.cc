#include "server/identity/expiry.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include <fmt/chrono.h>
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
  return std::min(FromUnixMs(std::int64_t{timegm(&utc)} * 1000), kNoExpiry);
}

absl::StatusOr<SystemTime> ExpiryOfFile(const std::string& pem_file) {
  const auto certificate = ReadPem(pem_file);
  if (!certificate.ok()) return certificate.status();
  return ExpiryOf(*certificate);
}

std::string ExpiryText(SystemTime expiry) {
  if (expiry >= kNoExpiry) return "never";
  // Not std::chrono::system_clock: its nanoseconds end in the year 2262.
  const auto seconds = std::chrono::floor<std::chrono::seconds>(expiry.time_since_epoch());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(static_cast<std::time_t>(seconds.count())));
}

}  // namespace uplink::identity
