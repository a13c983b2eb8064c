#include "server/identity/served_pems.h"

#include <array>
#include <memory>
#include <string_view>

#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

namespace uplink::identity {
namespace {

struct BioFree {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
struct X509Free {
  void operator()(X509* certificate) const { X509_free(certificate); }
};

std::string Sha256(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::size_t CertificatesIn(std::string_view text) {
  const std::unique_ptr<BIO, BioFree> bio(
      BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  std::size_t count = 0;
  char no_phrase[] = "";
  while (const std::unique_ptr<X509, X509Free> next{
      PEM_read_bio_X509_AUX(bio.get(), nullptr, nullptr, no_phrase)}) {
    ++count;
  }
  ERR_clear_error();
  return count;
}

}  // namespace

absl::StatusOr<ServedPems> ServedPemsOf(const NamedPem& certificate, const NamedPem& client_ca) {
  const auto expiry = ExpiryOf(certificate);
  if (!expiry.ok()) return expiry.status();
  return ServedPems{.expiry = *expiry,
                    .certificate_sha256 = Sha256(certificate.text),
                    .client_ca_sha256 = Sha256(client_ca.text),
                    .authorities = CertificatesIn(client_ca.text)};
}

}  // namespace uplink::identity
