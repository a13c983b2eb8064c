#include "server/identity/deny_list.h"

#include <algorithm>
#include <optional>

#include <openssl/ssl.h>
#include <openssl/x509.h>

namespace uplink::identity {
namespace {

constexpr std::size_t kDigestBytes = ShownCertificate::Sha256().size();

std::optional<unsigned> DigitOf(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a') + 10U;
  return std::nullopt;
}

/// The bytes of 64 lower-case hexadecimal digits.
std::optional<std::string> DigestOf(std::string_view hex) {
  if (hex.size() != 2 * kDigestBytes) return std::nullopt;
  std::string bytes;
  bytes.reserve(kDigestBytes);
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    const std::optional<unsigned> high = DigitOf(hex[i]);
    const std::optional<unsigned> low = DigitOf(hex[i + 1]);
    if (!high || !low) return std::nullopt;
    bytes += static_cast<char>(*high * 16U + *low);
  }
  return bytes;
}

std::string_view BytesOf(const ShownCertificate::Sha256& digest) {
  // Looking at bytes as char is always allowed.
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

bool NamesIssued(const DeniedCertificates& list, const X509& certificate, std::string_view serial) {
  return list.NamesSerial(serial) && list.NamesIssued(serial, IssuerOf(certificate));
}

}  // namespace

bool DeniedCertificates::Add(storage::RevokedBy by, std::string_view value) {
  if (by == storage::RevokedBy::kIssuerSerial) {
    const std::size_t space = value.find(' ');
    if (space == 0 || space == std::string_view::npos) return false;
    by_issuer_serial_.emplace(value);
    serials_.emplace(value.substr(0, space));
    return true;
  }
  std::optional<std::string> digest = DigestOf(value);
  if (!digest) return false;
  (by == storage::RevokedBy::kKey ? by_key_ : by_certificate_).insert(*std::move(digest));
  return true;
}

bool DeniedCertificates::NamesDigest(const ShownCertificate& certificate) const {
  if (certificate.serial.empty()) return false;
  return by_certificate_.contains(BytesOf(certificate.sha256)) ||
         by_key_.contains(BytesOf(certificate.key_sha256));
}

bool DeniedCertificates::NamesSerial(std::string_view serial) const {
  return serials_.contains(serial);
}

bool DeniedCertificates::NamesIssued(std::string_view serial, std::string_view issuer) const {
  std::string text;
  text.reserve(serial.size() + 1 + issuer.size());
  text.append(serial).append(" ").append(issuer);
  return by_issuer_serial_.contains(text);
}

NamedCertificate NamedBy(const X509& certificate) {
  return {ShownBy(certificate), IssuerOf(certificate)};
}

bool Denies(const DeniedCertificates& list, const std::vector<NamedCertificate>& chain) {
  return std::ranges::any_of(chain, [&list](const NamedCertificate& each) {
    return list.NamesDigest(each.shown) || (list.NamesSerial(each.shown.serial) &&
                                            list.NamesIssued(each.shown.serial, each.issuer));
  });
}

bool Denies(const DeniedCertificates& list, const SSL* connection, const ShownCertificate& shown) {
  if (list.size() == 0) return false;
  const X509* const own = SSL_get0_peer_certificate(connection);
  if (own == nullptr) return false;
  if (list.NamesDigest(shown) || NamesIssued(list, *own, shown.serial)) return true;
  const STACK_OF(X509)* const chain = SSL_get0_verified_chain(connection);
  // The last is ours: who takes it back takes it out of the file of authorities.
  for (int i = 1; i + 1 < sk_X509_num(chain); ++i) {
    const X509& signer = *sk_X509_value(chain, i);
    const ShownCertificate its = ShownBy(signer);
    if (list.NamesDigest(its) || NamesIssued(list, signer, its.serial)) return true;
  }
  return false;
}

}  // namespace uplink::identity
