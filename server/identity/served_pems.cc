#include "server/identity/served_pems.h"

#include <array>
#include <string_view>

#include <fmt/core.h>
#include <openssl/sha.h>

#include "server/identity/expiry.h"
#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

std::string Sha256(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  std::string hex;
  for (const unsigned char byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

}  // namespace

absl::StatusOr<ServedPems> ServedPemsOf(const NamedPem& certificate, const NamedPem& client_ca) {
  const auto expiry = ExpiryOf(certificate);
  if (!expiry.ok()) return expiry.status();
  const auto authorities = ReadCertificates(client_ca);
  return ServedPems{.expiry = *expiry,
                    .certificate_sha256 = Sha256(certificate.text),
                    .client_ca_sha256 = Sha256(client_ca.text),
                    .authorities = authorities.ok() ? authorities->size() : 0};
}

}  // namespace uplink::identity
