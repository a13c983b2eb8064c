#include "server/identity/server_pair.h"

#include <array>
#include <cstddef>
#include <ctime>
#include <fstream>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

/// Of a file at once.
constexpr std::size_t kReadBytes = std::size_t{16} * 1024;

absl::Status Unfit(const std::string& text) { return absl::FailedPreconditionError(text); }

absl::StatusOr<Certificate> ParseCertificate(const NamedPem& pem) {
  Certificate certificate(PEM_read_bio_X509(PemReader(pem.text).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (certificate == nullptr) return Unfit(fmt::format("{}: holds no PEM certificate", pem.name));
  return certificate;
}

absl::StatusOr<Key> ParseKey(const NamedPem& pem) {
  Key key = ReadKey(pem.text);
  ERR_clear_error();
  if (key == nullptr) {
    return Unfit(fmt::format("{}: holds no PEM private key without a pass phrase", pem.name));
  }
  return key;
}

/// The certificate, if the key is its own.
absl::StatusOr<Certificate> ParsePair(const NamedPem& certificate_pem, const NamedPem& key_pem) {
  auto certificate = ParseCertificate(certificate_pem);
  if (!certificate.ok()) return certificate.status();
  const auto key = ParseKey(key_pem);
  if (!key.ok()) return key.status();
  const bool match = X509_check_private_key(certificate->get(), key->get()) == 1;
  ERR_clear_error();
  if (!match)
    return Unfit(fmt::format("{}: is not the key of {}", key_pem.name, certificate_pem.name));
  return certificate;
}

}  // namespace

absl::StatusOr<NamedPem> ReadPem(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Unfit(fmt::format("{}: cannot be read", path));
  // Read each second: the most that a file may have is not taken for a small one.
  std::string text;
  std::array<char, kReadBytes> piece{};
  do {
    file.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  } while (file && text.size() <= kPemBytesMax);
  if (text.size() > kPemBytesMax) {
    return Unfit(fmt::format("{}: is larger than {} bytes", path, kPemBytesMax));
  }
  return NamedPem{path, std::move(text)};
}

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

absl::StatusOr<SystemTime> ExpiryOf(const NamedPem& pem) {
  const auto certificate = ParseCertificate(pem);
  if (!certificate.ok()) return certificate.status();
  std::tm utc{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(certificate->get()), &utc) != 1) {
    return Unfit(fmt::format("{}: holds no time of expiry", pem.name));
  }
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

}  // namespace uplink::identity
