#include "server/identity/shown_certificate.h"

#include <ctime>
#include <memory>
#include <string_view>

#include <openssl/bn.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

namespace uplink::identity {
namespace {

struct NumberFree {
  void operator()(BIGNUM* number) const { BN_free(number); }
};
struct TextFree {
  void operator()(char* text) const { OPENSSL_free(text); }
};

std::string SerialOf(const X509& certificate) {
  const std::unique_ptr<BIGNUM, NumberFree> number(
      ASN1_INTEGER_to_BN(X509_get0_serialNumber(&certificate), nullptr));
  if (number == nullptr) return {};
  const std::unique_ptr<char, TextFree> text(BN_bn2hex(number.get()));
  if (text == nullptr) return {};
  return std::string(std::string_view(text.get()).substr(0, kSerialTextBytesMax));
}

std::string HexOf(const ShownCertificate::Sha256& digest) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text;
  text.reserve(2 * digest.size());
  for (const std::uint8_t byte : digest) {
    text += kHex[byte >> 4U];
    text += kHex[byte & 0xFU];
  }
  return text;
}

}  // namespace

SystemTime NotAfterOf(const X509& certificate) {
  std::tm utc{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &utc) != 1) return SystemTime{};
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

ShownCertificate ShownBy(const X509& certificate) {
  ShownCertificate shown;
  shown.serial = SerialOf(certificate);
  shown.not_after = NotAfterOf(certificate);
  unsigned int size = 0;
  X509_digest(&certificate, EVP_sha256(), shown.sha256.data(), &size);
  X509_pubkey_digest(&certificate, EVP_sha256(), shown.key_sha256.data(), &size);
  ERR_clear_error();
  return shown;
}

storage::CertificateFacts FactsOf(const ShownCertificate& certificate) {
  if (certificate.serial.empty()) return {};
  return {.serial = certificate.serial,
          .sha256 = HexOf(certificate.sha256),
          .key_sha256 = HexOf(certificate.key_sha256),
          .not_after = certificate.not_after};
}

}  // namespace uplink::identity
