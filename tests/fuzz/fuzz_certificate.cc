#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include "schema/base/check.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/public_key_gate.h"

namespace {

namespace identity = uplink::identity;

struct X509Free {
  void operator()(X509* certificate) const { X509_free(certificate); }
};

int BitsOf(const EVP_PKEY& key, const char* number) {
  BIGNUM* value = nullptr;
  UPLINK_CHECK(EVP_PKEY_get_bn_param(&key, number, &value) == 1, "an RSA key has its numbers");
  const int bits = BN_num_bits(value);
  BN_free(value);
  return bits;
}

void CheckCurve(const EVP_PKEY& key) {
  char curve[64] = {};
  std::size_t size = 0;
  UPLINK_CHECK(EVP_PKEY_get_group_name(&key, curve, sizeof curve, &size) == 1, "a named curve");
  const int nid = OBJ_sn2nid(curve);
  UPLINK_CHECK(nid == NID_X9_62_prime256v1 || nid == NID_secp384r1 || nid == NID_secp521r1,
               "a curve that is taken");
}

void CheckKey(const EVP_PKEY& key) {
  switch (EVP_PKEY_get_base_id(&key)) {
    case EVP_PKEY_ED25519:
    case EVP_PKEY_ED448:
      return;
    case EVP_PKEY_EC:
      CheckCurve(key);
      return;
    case EVP_PKEY_RSA:
    case EVP_PKEY_RSA_PSS:
      UPLINK_CHECK(BitsOf(key, OSSL_PKEY_PARAM_RSA_N) <= int{identity::kRsaBitsMax}, "the modulus");
      UPLINK_CHECK(BitsOf(key, OSSL_PKEY_PARAM_RSA_E) <= int{identity::kRsaExponentBitsMax},
                   "the exponent");
      return;
    default:
      UPLINK_CHECK(false, "a kind of key that is not taken");
  }
}

void CheckCertificate(identity::Bytes certificate) {
  if (identity::FlawOfCertificate(certificate) != identity::CertificateFlaw::kNone) return;
  const unsigned char* bytes = certificate.data();
  const std::unique_ptr<X509, X509Free> read(
      d2i_X509(nullptr, &bytes, static_cast<long>(certificate.size())));
  if (read != nullptr) {
    const EVP_PKEY* key = X509_get0_pubkey(read.get());
    if (key != nullptr) CheckKey(*key);
  }
  ERR_clear_error();
}

}  // namespace

/// What the gate lets through, OpenSSL either does not read, or finds a key in that is taken. The
/// first byte says what the others are: a certificate, or a message of TLS 1.2 or 1.3.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const identity::Bytes rest(data + 1, size - 1);
  switch (data[0]) {
    case 0:
      CheckCertificate(rest);
      break;
    case 1:
      static_cast<void>(identity::FlawOfMessage(identity::MessageForm::kTls12, rest));
      break;
    default:
      static_cast<void>(identity::FlawOfMessage(identity::MessageForm::kTls13, rest));
  }
  return 0;
}
