#include "server/health/certificate.h"

#include <ctime>
#include <memory>

#include <absl/status/status.h>
#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

namespace uplink::health {
namespace {

struct FreeBio {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
struct FreeX509 {
  void operator()(X509* certificate) const { X509_free(certificate); }
};

}  // namespace

absl::StatusOr<SystemTime> CertificateExpiry(const std::string& pem_file) {
  const std::unique_ptr<BIO, FreeBio> file(BIO_new_file(pem_file.c_str(), "r"));
  if (file == nullptr) {
    return absl::FailedPreconditionError(fmt::format("{}: cannot be read", pem_file));
  }
  const std::unique_ptr<X509, FreeX509> certificate(
      PEM_read_bio_X509(file.get(), nullptr, nullptr, nullptr));
  std::tm utc{};
  if (certificate == nullptr || ASN1_TIME_to_tm(X509_get0_notAfter(certificate.get()), &utc) != 1) {
    return absl::FailedPreconditionError(fmt::format("{}: holds no certificate", pem_file));
  }
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

}  // namespace uplink::health
