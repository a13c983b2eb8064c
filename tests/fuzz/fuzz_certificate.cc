#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509v3.h>

#include "schema/base/check.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"
#include "server/identity/public_key_gate.h"

namespace {

namespace identity = uplink::identity;

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

/// What OpenSSL reads of an extension; null if there is none, or it is unreadable.
template <typename Value>
std::unique_ptr<Value, void (*)(Value*)> ExtensionOf(const X509& certificate, int nid,
                                                     void (*release)(Value*)) {
  return {static_cast<Value*>(X509_get_ext_d2i(&certificate, nid, nullptr, nullptr)), release};
}

std::size_t NamesOf(const X509& certificate, int nid) {
  const auto names = ExtensionOf(certificate, nid, GENERAL_NAMES_free);
  return static_cast<std::size_t>(std::max(0, sk_GENERAL_NAME_num(names.get())));
}

std::size_t ConstraintsOf(const X509& certificate) {
  const auto all = ExtensionOf(certificate, NID_name_constraints, NAME_CONSTRAINTS_free);
  if (all == nullptr) return 0;
  return static_cast<std::size_t>(std::max(0, sk_GENERAL_SUBTREE_num(all->permittedSubtrees)) +
                                  std::max(0, sk_GENERAL_SUBTREE_num(all->excludedSubtrees)));
}

std::size_t IssuersOf(const X509& certificate) {
  const auto key = ExtensionOf(certificate, NID_authority_key_identifier, AUTHORITY_KEYID_free);
  return key == nullptr ? 0
                        : static_cast<std::size_t>(std::max(0, sk_GENERAL_NAME_num(key->issuer)));
}

std::size_t PointsOf(const X509& certificate) {
  const auto points = ExtensionOf(certificate, NID_crl_distribution_points, CRL_DIST_POINTS_free);
  std::size_t names = 0;
  for (int i = 0; i < sk_DIST_POINT_num(points.get()); ++i) {
    const DIST_POINT* point = sk_DIST_POINT_value(points.get(), i);
    names += 1 + static_cast<std::size_t>(std::max(0, sk_GENERAL_NAME_num(point->CRLissuer)));
    if (point->distpoint == nullptr) continue;
    UPLINK_CHECK(point->distpoint->type == 0, "a point that is relative to its issuer");
    names +=
        static_cast<std::size_t>(std::max(0, sk_GENERAL_NAME_num(point->distpoint->name.fullname)));
  }
  return names;
}

/// The lists that OpenSSL reads before it knows who signed have no more elements than are counted.
void CheckLists(const X509& certificate) {
  UPLINK_CHECK(NamesOf(certificate, NID_subject_alt_name) +
                       NamesOf(certificate, NID_issuer_alt_name) + ConstraintsOf(certificate) +
                       IssuersOf(certificate) + PointsOf(certificate) <=
                   identity::kShownElementsMax,
               "elements that the gate did not count");
}

void CheckCertificate(identity::Bytes certificate) {
  if (identity::FlawOfCertificate(certificate) != identity::CertificateFlaw::kNone) return;
  const unsigned char* bytes = certificate.data();
  const identity::Certificate read(
      d2i_X509(nullptr, &bytes, static_cast<long>(certificate.size())));
  if (read != nullptr) {
    const EVP_PKEY* key = X509_get0_pubkey(read.get());
    if (key != nullptr) CheckKey(*key);
    CheckLists(*read);
  }
  ERR_clear_error();
}

}  // namespace

/// What the gate lets through, OpenSSL either does not read, or finds a key in that is taken and no
/// more elements than the gate counted. The first byte says what the others are: a certificate, or
/// a message of TLS 1.2 or 1.3.
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
