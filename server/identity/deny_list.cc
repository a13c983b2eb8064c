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

/// What signed a certificate of a verified chain; its last, and one without a chain, is its own.
const X509& SignerOf(const X509& certificate, const STACK_OF(X509) * chain, int at) {
  if (at + 1 >= sk_X509_num(chain)) return certificate;
  return *sk_X509_value(chain, at + 1);
}

/// How many certificates of the chain are the peer's. The last is ours: who takes it back takes it
/// out of the file of authorities.
int ShownOf(const STACK_OF(X509) * chain) { return std::max(1, sk_X509_num(chain) - 1); }

std::string SignedText(std::string_view serial, const ShownCertificate::Sha256& signer) {
  return std::string(BytesOf(signer)).append(serial);
}

/// Whether the list names a certificate by anything. `issuer` and `signer` return its issuer and
/// the digest of the key that signed it; they are called only for a serial that the list holds.
template <typename Issuer, typename Signer>
bool Names(const DeniedCertificates& list, const ShownCertificate& shown, const Issuer& issuer,
           const Signer& signer) {
  if (list.NamesDigest(shown)) return true;
  return list.NamesSerial(shown.serial) &&
         (list.NamesIssued(shown.serial, issuer()) || list.NamesSigned(shown.serial, signer()));
}

bool Names(const DeniedCertificates& list, const NamedCertificate& certificate) {
  return Names(
      list, certificate.shown, [&]() -> const std::string& { return certificate.issuer; },
      [&] { return certificate.signer; });
}

bool Names(const DeniedCertificates& list, const X509& certificate, const ShownCertificate& shown,
           const X509& signer) {
  return Names(
      list, shown, [&] { return IssuerOf(certificate); }, [&] { return KeyDigestOf(signer); });
}

/// False: the value is no digest.
bool AddDigest(std::string_view value, auto& digests) {
  std::optional<std::string> digest = DigestOf(value);
  if (!digest) return false;
  digests.insert(*std::move(digest));
  return true;
}

}  // namespace

bool DeniedCertificates::Add(storage::RevokedBy by, std::string_view value) {
  switch (by) {
    case storage::RevokedBy::kIssuerSerial: {
      const std::size_t space = value.find(' ');
      if (space == 0 || space == std::string_view::npos) return false;
      by_issuer_serial_.emplace(value);
      serials_.emplace(value.substr(0, space));
      return true;
    }
    case storage::RevokedBy::kCertificate:
      return AddDigest(value, by_certificate_);
    case storage::RevokedBy::kKey:
      return AddDigest(value, by_key_);
  }
  return false;
}

void DeniedCertificates::Add(const SignedSerial& certificate) {
  by_signer_serial_.insert(SignedText(certificate.serial, certificate.signer));
  serials_.insert(certificate.serial);
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

bool DeniedCertificates::NamesSigned(std::string_view serial,
                                     const ShownCertificate::Sha256& signer) const {
  return by_signer_serial_.contains(SignedText(serial, signer));
}

std::vector<NamedCertificate> NamedBy(const X509& own, const STACK_OF(X509) * chain) {
  std::vector<NamedCertificate> named;
  for (int i = 0; i < ShownOf(chain); ++i) {
    const X509* const at = i == 0 ? &own : sk_X509_value(chain, i);
    const X509& each = *at;
    named.push_back({.shown = ShownBy(each),
                     .issuer = IssuerOf(each),
                     .signer = KeyDigestOf(SignerOf(each, chain, i))});
  }
  return named;
}

bool Denies(const DeniedCertificates& list, const std::vector<NamedCertificate>& chain) {
  return std::ranges::any_of(chain,
                             [&list](const NamedCertificate& each) { return Names(list, each); });
}

bool Denies(const DeniedCertificates& list, const SSL* connection, const ShownCertificate& shown) {
  if (list.size() == 0) return false;
  const X509* const own = SSL_get0_peer_certificate(connection);
  if (own == nullptr) return false;
  const STACK_OF(X509)* const chain = SSL_get0_verified_chain(connection);
  if (Names(list, *own, shown, SignerOf(*own, chain, 0))) return true;
  for (int i = 1; i < ShownOf(chain); ++i) {
    const X509& each = *sk_X509_value(chain, i);
    if (Names(list, each, ShownBy(each), SignerOf(each, chain, i))) return true;
  }
  return false;
}

}  // namespace uplink::identity
