#include "server/identity/shown_certificate.h"

#include <ctime>
#include <memory>
#include <string_view>
#include <utility>

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

struct NumberFree {
  void operator()(BIGNUM* number) const { BN_free(number); }
};
struct TextFree {
  void operator()(char* text) const { OPENSSL_free(text); }
};

/// A key that a certificate may write in more than one form: a compressed point, or RSA without its
/// parameters or restricted to PSS.
bool HasOddForm(const X509_PUBKEY* key) {
  const unsigned char* bytes = nullptr;
  int size = 0;
  X509_ALGOR* algorithm = nullptr;
  ASN1_OBJECT* oid = nullptr;
  if (X509_PUBKEY_get0_param(&oid, &bytes, &size, &algorithm, key) != 1) return false;
  switch (OBJ_obj2nid(oid)) {
    case NID_X9_62_id_ecPublicKey:
      return size > 0 && bytes[0] != POINT_CONVERSION_UNCOMPRESSED;
    case NID_rsassaPss:
      return true;
    case NID_rsaEncryption: {
      int type = V_ASN1_UNDEF;
      X509_ALGOR_get0(nullptr, &type, nullptr, algorithm);
      return type != V_ASN1_NULL;
    }
    default:  // the others have one form
      return false;
  }
}

struct PublicKeyFree {
  void operator()(X509_PUBKEY* key) const { X509_PUBKEY_free(key); }
};

/// The key of RSA, whatever it is restricted to, as rsaEncryption; empty if it is of another kind.
std::string UsualRsa(const X509_PUBKEY& key) {
  const unsigned char* bytes = nullptr;
  int size = 0;
  ASN1_OBJECT* oid = nullptr;
  if (X509_PUBKEY_get0_param(&oid, &bytes, &size, nullptr, &key) != 1) return {};
  const int kind = OBJ_obj2nid(oid);
  if (kind != NID_rsaEncryption && kind != NID_rsassaPss) return {};
  const std::unique_ptr<X509_PUBKEY, PublicKeyFree> usual(X509_PUBKEY_new());
  auto* const copy =
      static_cast<unsigned char*>(OPENSSL_memdup(bytes, static_cast<std::size_t>(size)));
  // It takes the copy over.
  if (usual == nullptr || X509_PUBKEY_set0_param(usual.get(), OBJ_nid2obj(NID_rsaEncryption),
                                                 V_ASN1_NULL, nullptr, copy, size) != 1) {
    OPENSSL_free(copy);
    return {};
  }
  unsigned char* der = nullptr;
  const int der_size = i2d_X509_PUBKEY(usual.get(), &der);
  if (der_size <= 0) return {};
  std::string text(der, der + der_size);
  OPENSSL_free(der);
  return text;
}

/// The usual form of such a key; empty if the library cannot read it.
std::string UsualForm(const X509_PUBKEY& shown, const std::string& der) {
  if (std::string rsa = UsualRsa(shown); !rsa.empty()) return rsa;
  const auto* from = reinterpret_cast<const unsigned char*>(der.data());
  // Its own: another point form is set in the key.
  const Key key(d2i_PUBKEY(nullptr, &from, static_cast<long>(der.size())));
  if (key == nullptr) return {};
  if (EVP_PKEY_is_a(key.get(), "EC") == 1) {
    EVP_PKEY_set_utf8_string_param(key.get(), OSSL_PKEY_PARAM_EC_POINT_CONVERSION_FORMAT,
                                   OSSL_PKEY_EC_POINT_CONVERSION_FORMAT_UNCOMPRESSED);
  }
  unsigned char* bytes = nullptr;
  const int size = i2d_PUBKEY(key.get(), &bytes);
  if (size <= 0) return {};
  std::string usual(bytes, bytes + size);
  OPENSSL_free(bytes);
  return usual;
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

std::string SerialText(const ASN1_INTEGER& serial) {
  const std::unique_ptr<BIGNUM, NumberFree> number(ASN1_INTEGER_to_BN(&serial, nullptr));
  if (number == nullptr) return {};
  const std::unique_ptr<char, TextFree> text(BN_bn2hex(number.get()));
  if (text == nullptr) return {};
  return std::string(std::string_view(text.get()).substr(0, kSerialTextBytesMax));
}

std::string NameOf(const X509_NAME& name) {
  const Bio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr || X509_NAME_print_ex(bio.get(), &name, 0, XN_FLAG_RFC2253) < 0) {
    ERR_clear_error();
    return {};
  }
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

std::string IssuerOf(const X509& certificate) {
  return NameOf(*X509_get_issuer_name(&certificate));
}

SystemTime NotAfterOf(const X509& certificate) {
  std::tm utc{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &utc) != 1) return SystemTime{};
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

ShownCertificate::Sha256 DigestOf(const X509& certificate) {
  ShownCertificate::Sha256 digest{};
  unsigned int size = 0;
  X509_digest(&certificate, EVP_sha256(), digest.data(), &size);
  return digest;
}

ShownCertificate::Sha256 KeyDigestOf(const X509& certificate) {
  const X509_PUBKEY* const key = X509_get_X509_PUBKEY(&certificate);
  unsigned char* bytes = nullptr;
  const int size = i2d_X509_PUBKEY(key, &bytes);
  if (size <= 0) return {};
  std::string der(bytes, bytes + size);
  OPENSSL_free(bytes);
  if (HasOddForm(key)) {
    if (std::string usual = UsualForm(*key, der); !usual.empty()) der = std::move(usual);
  }
  ShownCertificate::Sha256 digest{};
  EVP_Digest(der.data(), der.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  return digest;
}

ShownCertificate ShownBy(const X509& certificate) {
  ShownCertificate shown;
  shown.serial = SerialText(*X509_get0_serialNumber(&certificate));
  shown.not_after = NotAfterOf(certificate);
  shown.sha256 = DigestOf(certificate);
  shown.key_sha256 = KeyDigestOf(certificate);
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
