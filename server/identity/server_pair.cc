#include "server/identity/server_pair.h"

#include <string>
#include <utility>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

absl::Status Unfit(const std::string& text) { return absl::FailedPreconditionError(text); }

/// The first certificate, if the key is its own.
absl::StatusOr<Certificate> ParsePair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  auto certificates = ReadCertificates(certificate_pem);
  if (!certificates.ok()) return certificates.status();
  const auto key = ReadKey(key_pem);
  if (!key.ok()) return key.status();
  Certificate own = std::move(certificates->front());
  const bool match = X509_check_private_key(own.get(), key->get()) == 1;
  ERR_clear_error();
  if (!match)
    return Unfit(fmt::format("{}: is not the key of {}", key_pem.name, certificate_pem.name));
  return own;
}

}  // namespace

absl::Status CheckCertificates(const NamedPem& certificates) {
  return ReadCertificates(certificates).status();
}

absl::Status CheckKey(const NamedPem& key) { return ReadKey(key).status(); }

absl::Status CheckServerPair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  const auto certificate = ParsePair(certificate_pem, key_pem);
  if (!certificate.ok()) return certificate.status();
  const bool serves = X509_check_purpose(certificate->get(), X509_PURPOSE_SSL_SERVER, 0) == 1;
  ERR_clear_error();
  if (!serves) {
    return Unfit(fmt::format("{}: is no certificate of a server (extended key usage serverAuth)",
                             certificate_pem.name));
  }
  return absl::OkStatus();
}

absl::Status CheckClientPair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  return ParsePair(certificate_pem, key_pem).status();
}

}  // namespace uplink::identity
