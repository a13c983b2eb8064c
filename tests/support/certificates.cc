#include "tests/support/certificates.h"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/core_names.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/objects.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include "schema/base/check.h"
#include "tests/support/openssl_owners.h"

namespace uplink::testing {
namespace {

using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using Bio = std::unique_ptr<BIO, FreeWith<BIO_free>>;
using Names = std::unique_ptr<GENERAL_NAMES, FreeWith<GENERAL_NAMES_free>>;
using Usages = std::unique_ptr<EXTENDED_KEY_USAGE, FreeWith<EXTENDED_KEY_USAGE_free>>;
using Constraints = std::unique_ptr<BASIC_CONSTRAINTS, FreeWith<BASIC_CONSTRAINTS_free>>;

void Require(bool done) { UPLINK_CHECK(done, "OpenSSL refused to make a test certificate"); }

Key NewKey(const std::string& kind = "P-256") {
  constexpr std::size_t kRsaBits = 2048;
  constexpr std::size_t kWeakRsaBits = 1024;
  Key key(nullptr);
  if (kind.starts_with("RSA")) {
    key.reset(EVP_RSA_gen(kind == "RSA" ? kRsaBits : kWeakRsaBits));
  } else if (kind.starts_with("P-") || kind.starts_with("secp") || kind.starts_with("brainpool")) {
    key.reset(EVP_EC_gen(kind.c_str()));
  } else {
    key.reset(EVP_PKEY_Q_keygen(nullptr, nullptr, kind.c_str()));
  }
  Require(key != nullptr);
  return key;
}

const unsigned char* Bytes(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

std::string TextOf(const Bio& bio) {
  char* data = nullptr;
  const auto length = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(length)};
}

std::string PemOf(X509* certificate) {
  const Bio bio(BIO_new(BIO_s_mem()));
  Require(PEM_write_bio_X509(bio.get(), certificate) == 1);
  return TextOf(bio);
}

std::string PemOf(EVP_PKEY* key) {
  const Bio bio(BIO_new(BIO_s_mem()));
  Require(PEM_write_bio_PKCS8PrivateKey(bio.get(), key, nullptr, nullptr, 0, nullptr, nullptr) ==
          1);
  return TextOf(bio);
}

void AddSubject(X509_NAME* subject, int nid, const std::vector<std::string>& values) {
  for (const std::string& value : values) {
    Require(X509_NAME_add_entry_by_NID(subject, nid, V_ASN1_UTF8STRING, Bytes(value),
                                       static_cast<int>(value.size()), -1, 0) == 1);
  }
}

void AddName(GENERAL_NAMES* names, int type, const std::string& value) {
  GENERAL_NAME* name = GENERAL_NAME_new();
  ASN1_IA5STRING* text = ASN1_IA5STRING_new();
  Require(ASN1_STRING_set(text, value.data(), static_cast<int>(value.size())) == 1);
  GENERAL_NAME_set0_value(name, type, text);
  Require(sk_GENERAL_NAME_push(names, name) > 0);
}

void AddAddress(GENERAL_NAMES* names, const std::string& address) {
  GENERAL_NAME* name = GENERAL_NAME_new();
  ASN1_OCTET_STRING* bytes = a2i_IPADDRESS(address.c_str());
  Require(bytes != nullptr);
  GENERAL_NAME_set0_value(name, GEN_IPADD, bytes);
  Require(sk_GENERAL_NAME_push(names, name) > 0);
}

void AddNames(X509* certificate, const CertificateSpec& spec) {
  const Names names(GENERAL_NAMES_new());
  for (const std::string& uri : spec.uris) AddName(names.get(), GEN_URI, uri);
  for (const std::string& dns_name : spec.dns_names) AddName(names.get(), GEN_DNS, dns_name);
  for (const std::string& address : spec.ip_addresses) AddAddress(names.get(), address);
  if (sk_GENERAL_NAME_num(names.get()) == 0) return;
  Require(X509_add1_ext_i2d(certificate, NID_subject_alt_name, names.get(), 0,
                            X509V3_ADD_DEFAULT) == 1);
}

void AddUsages(X509* certificate, const std::vector<std::string>& key_usages) {
  if (key_usages.empty()) return;
  const Usages usages(EXTENDED_KEY_USAGE_new());
  for (const std::string& usage : key_usages) {
    ASN1_OBJECT* object = OBJ_txt2obj(usage.c_str(), 0);
    Require(object != nullptr);
    Require(sk_ASN1_OBJECT_push(usages.get(), object) > 0);
  }
  Require(X509_add1_ext_i2d(certificate, NID_ext_key_usage, usages.get(), 0, X509V3_ADD_DEFAULT) ==
          1);
}

void AddConstraints(X509* certificate, bool is_authority) {
  const Constraints constraints(BASIC_CONSTRAINTS_new());
  // DER knows one byte for true; Go takes no other.
  constraints->ca = is_authority ? 0xFF : 0;
  Require(X509_add1_ext_i2d(certificate, NID_basic_constraints, constraints.get(), 1,
                            X509V3_ADD_DEFAULT) == 1);
}

void AddNameConstraints(X509* certificate, const std::string& words) {
  if (words.empty()) return;
  X509_EXTENSION* extension =
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_name_constraints, words.c_str());
  Require(extension != nullptr && X509_add_ext(certificate, extension, -1) == 1);
  X509_EXTENSION_free(extension);
}

void SetSerial(X509* certificate) {
  unsigned char bytes[8];
  Require(RAND_bytes(bytes, sizeof(bytes)) == 1);
  bytes[0] &= 0x7F;
  BIGNUM* number = BN_bin2bn(bytes, sizeof(bytes), nullptr);
  Require(BN_to_ASN1_INTEGER(number, X509_get_serialNumber(certificate)) != nullptr);
  BN_free(number);
}

/// `issuer` null: it signs itself.
Certificate NewCertificate(const CertificateSpec& spec, EVP_PKEY* key, X509* issuer,
                           EVP_PKEY* issuer_key) {
  Certificate certificate(X509_new());
  X509* x509 = certificate.get();
  Require(x509 != nullptr && X509_set_version(x509, X509_VERSION_3) == 1);
  SetSerial(x509);
  Require(X509_gmtime_adj(X509_getm_notBefore(x509), spec.not_before_s) != nullptr);
  Require(X509_gmtime_adj(X509_getm_notAfter(x509), spec.not_after_s) != nullptr);
  X509_NAME* subject = X509_get_subject_name(x509);
  AddSubject(subject, NID_organizationName, spec.organizations);
  AddSubject(subject, NID_organizationalUnitName, spec.units);
  AddSubject(subject, NID_commonName, spec.common_names);
  Require(X509_set_issuer_name(x509, issuer != nullptr ? X509_get_subject_name(issuer) : subject) ==
          1);
  Require(X509_set_pubkey(x509, key) == 1);
  AddConstraints(x509, spec.is_authority);
  AddNameConstraints(x509, spec.name_constraints);
  AddUsages(x509, spec.key_usages);
  AddNames(x509, spec);
  Require(X509_sign(x509, issuer_key, EVP_sha256()) > 0);
  return certificate;
}

CertificateSpec AuthoritySpec(const std::string& name) {
  CertificateSpec spec;
  spec.common_names = {name};
  spec.key_usages.clear();
  spec.is_authority = true;
  return spec;
}

}  // namespace

CertificateSpec RobotSpec(const std::string& ruri, const std::string& fleet) {
  CertificateSpec spec;
  spec.common_names = {"a robot"};
  if (!fleet.empty()) spec.organizations = {fleet};
  spec.uris = {ruri};
  return spec;
}

CertificateSpec ServerSpec() {
  CertificateSpec spec;
  spec.common_names = {"localhost"};
  spec.dns_names = {"localhost"};
  spec.ip_addresses = {"127.0.0.1", "::1"};
  spec.key_usages = {"serverAuth"};
  return spec;
}

struct TestAuthority::Impl {
  Key key;
  Certificate certificate;
  std::string pem;
};

TestAuthority::TestAuthority(const std::string& name) : impl_(std::make_unique<Impl>()) {
  impl_->key = NewKey();
  impl_->certificate =
      NewCertificate(AuthoritySpec(name), impl_->key.get(), nullptr, impl_->key.get());
  impl_->pem = PemOf(impl_->certificate.get());
}

TestAuthority::TestAuthority(const std::string& name, const TestAuthority& issuer,
                             const std::string& name_constraints)
    : impl_(std::make_unique<Impl>()) {
  impl_->key = NewKey();
  CertificateSpec spec = AuthoritySpec(name);
  spec.name_constraints = name_constraints;
  impl_->certificate = NewCertificate(spec, impl_->key.get(), issuer.impl_->certificate.get(),
                                      issuer.impl_->key.get());
  impl_->pem = PemOf(impl_->certificate.get());
}

TestAuthority::~TestAuthority() = default;

const std::string& TestAuthority::certificate() const { return impl_->pem; }

KeyPair TestAuthority::Issue(const CertificateSpec& spec) const {
  const Key key = NewKey(spec.key);
  if (spec.compressed) {
    Require(EVP_PKEY_set_utf8_string_param(key.get(), OSSL_PKEY_PARAM_EC_POINT_CONVERSION_FORMAT,
                                           "compressed") == 1);
  }
  const Certificate certificate =
      NewCertificate(spec, key.get(), impl_->certificate.get(), impl_->key.get());
  return {PemOf(certificate.get()), PemOf(key.get())};
}

std::string TestAuthority::Revoke(const std::vector<KeyPair>& revoked, long next_update_s) const {
  const std::unique_ptr<X509_CRL, void (*)(X509_CRL*)> list(X509_CRL_new(), X509_CRL_free);
  Require(X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1);
  Require(X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(impl_->certificate.get())) ==
          1);
  ASN1_TIME* time = X509_gmtime_adj(nullptr, -2 * 3600);
  Require(X509_CRL_set1_lastUpdate(list.get(), time) == 1);
  for (const KeyPair& each : revoked) {
    const Bio bio(
        BIO_new_mem_buf(each.certificate.data(), static_cast<int>(each.certificate.size())));
    const Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
    Require(certificate != nullptr);
    X509_REVOKED* entry = X509_REVOKED_new();
    Require(X509_REVOKED_set_serialNumber(entry, X509_get_serialNumber(certificate.get())) == 1);
    Require(X509_REVOKED_set_revocationDate(entry, time) == 1);
    Require(X509_CRL_add0_revoked(list.get(), entry) == 1);
  }
  Require(X509_gmtime_adj(time, next_update_s) != nullptr);
  Require(X509_CRL_set1_nextUpdate(list.get(), time) == 1);
  ASN1_TIME_free(time);
  Require(X509_CRL_sort(list.get()) == 1);
  Require(X509_CRL_sign(list.get(), impl_->key.get(), EVP_sha256()) > 0);
  const Bio bio(BIO_new(BIO_s_mem()));
  Require(PEM_write_bio_X509_CRL(bio.get(), list.get()) == 1);
  return TextOf(bio);
}

}  // namespace uplink::testing
