#include "server/identity/server_pair.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "server/identity/der_reader.h"
#include "server/identity/pem.h"
#include "server/identity/public_key_gate.h"
#include "server/identity/strength.h"

namespace uplink::identity {
namespace {

void FreeBytes(std::uint8_t* bytes) { OPENSSL_free(bytes); }

absl::Status Unfit(const std::string& text) { return absl::FailedPreconditionError(text); }

/// Whether a TLS server can sign with a key of this kind.
bool Signs(const Certificate& certificate) {
  std::uint8_t* bytes = nullptr;
  const int size = i2d_X509_PUBKEY(X509_get_X509_PUBKEY(certificate.get()), &bytes);
  const std::unique_ptr<std::uint8_t, decltype(&FreeBytes)> owner(bytes, &FreeBytes);
  if (size <= 0) return false;
  const auto info = DerReader(Bytes(bytes, static_cast<std::size_t>(size))).Take(DerTag::kSequence);
  return info && FlawOfKey(*info) != KeyFlaw::kKind;
}

/// The first certificate, if the key belongs to it and both are strong enough.
absl::StatusOr<Certificate> ParsePair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  auto certificates = ReadCertificates(certificate_pem);
  if (!certificates.ok()) return certificates.status();
  const auto key = ReadKey(key_pem);
  if (!key.ok()) return key.status();
  Certificate own = std::move(certificates->front());
  const bool match = X509_check_private_key(own.get(), key->get()) == 1;
  ERR_clear_error();
  if (!match)
    return Unfit(fmt::format("{}: is not the key of {}; name two files that were issued together",
                             key_pem.name, certificate_pem.name));
  if (absl::Status strong = CheckStrength(certificate_pem, key_pem); !strong.ok()) return strong;
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
    return Unfit(fmt::format(
        "{}: is no certificate of a server (extended key usage serverAuth); issue one, as "
        "uplinkctl pki server does",
        certificate_pem.name));
  }
  if (!Signs(*certificate)) {
    return Unfit(fmt::format(
        "{}: its key is of a kind with which no TLS server signs; issue one with P-256, "
        "P-384, P-521, RSA, Ed25519 or Ed448",
        certificate_pem.name));
  }
  return absl::OkStatus();
}

absl::Status CheckClientPair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  return ParsePair(certificate_pem, key_pem).status();
}

}  // namespace uplink::identity
