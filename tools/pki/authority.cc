#include "tools/pki/authority.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "tools/pki/shown.h"

namespace uplink::pki {
namespace {

template <auto Free>
struct Freed {
  template <typename T>
  void operator()(T* pointer) const {
    Free(pointer);
  }
};
using identity::Certificate;
using identity::Key;
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;
using BigNumber = std::unique_ptr<BIGNUM, Freed<BN_free>>;

/// Random bits of a serial number: positive and within RFC 5280's 20 octets.
constexpr int kSerialBits = 127;
/// Digits of it in an authority's name.
constexpr std::size_t kNameDigits = 16;
/// A certificate is valid a little before it was made: clocks differ.
constexpr long kBackdateSeconds = 3600;

absl::Status Failed(const char* what) {
  std::array<char, 256> text{};
  ERR_error_string_n(ERR_get_error(), text.data(), text.size());
  ERR_clear_error();
  return absl::InternalError(fmt::format("OpenSSL: {}: {}", what, text.data()));
}

absl::Status Invalid(const absl::Status& status) {
  return absl::InvalidArgumentError(status.message());
}

std::string Take(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

std::string ToPem(X509* certificate) {
  const Bio bio(BIO_new(BIO_s_mem()));
  return PEM_write_bio_X509(bio.get(), certificate) == 1 ? Take(bio.get()) : std::string();
}

std::string ToPem(EVP_PKEY* key) {
  const Bio bio(BIO_new(BIO_s_mem()));
  const int ok =
      PEM_write_bio_PKCS8PrivateKey(bio.get(), key, nullptr, nullptr, 0, nullptr, nullptr);
  return ok == 1 ? Take(bio.get()) : std::string();
}

bool AddNamePart(X509_NAME* name, const char* field, const std::string& value) {
  if (value.empty()) return true;
  const auto* bytes = reinterpret_cast<const unsigned char*>(value.data());
  return X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8, bytes,
                                    static_cast<int>(value.size()), -1, 0) == 1;
}

bool AddExtension(X509* certificate, X509* issuer, int nid, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, nid, value.c_str()));
  return extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1;
}

bool SetRandomSerial(X509* certificate) {
  const BigNumber number(BN_new());
  return number != nullptr &&
         BN_rand(number.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
         BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}

bool SetValidity(X509* certificate, int days) {
  return X509_gmtime_adj(X509_getm_notBefore(certificate), -kBackdateSeconds) != nullptr &&
         X509_time_adj_ex(X509_getm_notAfter(certificate), days, 0, nullptr) != nullptr;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) {
    all += (all.empty() ? "" : ",") + name;
  }
  return all;
}

std::string ToDer(const X509* certificate) {
  unsigned char* bytes = nullptr;
  const int size = i2d_X509(certificate, &bytes);
  if (size <= 0) return {};
  std::string der(bytes, bytes + size);
  OPENSSL_free(bytes);
  return der;
}

/// Everything of a certificate but its subject, issuer, extensions and signature.
absl::StatusOr<Certificate> Blank(EVP_PKEY* key, int days) {
  if (days < 1 || days > kDaysMax) {
    return absl::InvalidArgumentError(
        fmt::format("a validity of {} days: it must be 1 to {}", days, kDaysMax));
  }
  Certificate certificate(X509_new());
  if (certificate == nullptr || X509_set_version(certificate.get(), X509_VERSION_3) != 1 ||
      !SetRandomSerial(certificate.get()) || !SetValidity(certificate.get(), days) ||
      X509_set_pubkey(certificate.get(), key) != 1) {
    return Failed("a new certificate");
  }
  return certificate;
}

absl::StatusOr<Key> NewKey() {
  Key key(EVP_EC_gen("P-256"));
  if (key == nullptr) return Failed("a new key");
  return key;
}

/// By its serial number, which is drawn at random.
std::string NewName(const X509& certificate) {
  const std::string serial = identity::SerialText(*X509_get0_serialNumber(&certificate));
  return fmt::format("uplinkd development authority {}", serial.substr(0, kNameDigits));
}

}  // namespace

struct Authority::Handles {
  Key key;
  Certificate certificate;
};

Authority::Authority(std::unique_ptr<Handles> handles, Credentials credentials)
    : handles_(std::move(handles)), credentials_(std::move(credentials)) {}
Authority::~Authority() = default;

absl::StatusOr<std::unique_ptr<Authority>> Authority::Create(const std::string& common_name,
                                                             int days) {
  absl::StatusOr<Key> key = NewKey();
  if (!key.ok()) return key.status();
  absl::StatusOr<Certificate> made = Blank(key->get(), days);
  if (!made.ok()) return made.status();
  X509* const certificate = made->get();
  X509_NAME* const name = X509_get_subject_name(certificate);
  if (!AddNamePart(name, "CN", common_name.empty() ? NewName(*certificate) : common_name) ||
      X509_set_issuer_name(certificate, name) != 1 ||
      !AddExtension(certificate, certificate, NID_basic_constraints,
                    "critical,CA:TRUE,pathlen:0") ||
      !AddExtension(certificate, certificate, NID_key_usage, "critical,keyCertSign,cRLSign") ||
      !AddExtension(certificate, certificate, NID_subject_key_identifier, "hash") ||
      X509_sign(certificate, key->get(), EVP_sha256()) == 0) {
    return Failed("a new authority");
  }
  Credentials credentials{ToPem(certificate), ToPem(key->get())};
  auto handles = std::make_unique<Handles>(Handles{std::move(*key), std::move(*made)});
  return std::unique_ptr<Authority>(new Authority(std::move(handles), std::move(credentials)));
}

absl::StatusOr<std::unique_ptr<Authority>> Authority::Load(const Credentials& credentials) {
  auto certificates =
      identity::ReadCertificates({"the authority's certificate", credentials.certificate_pem});
  if (!certificates.ok()) return Invalid(certificates.status());
  auto key = identity::ReadKey({"the authority's key", credentials.key_pem});
  if (!key.ok()) return Invalid(key.status());
  auto handles =
      std::make_unique<Handles>(Handles{*std::move(key), std::move(certificates->front())});
  if (X509_check_private_key(handles->certificate.get(), handles->key.get()) != 1) {
    ERR_clear_error();
    return absl::InvalidArgumentError(
        "ca.key is not the key of ca.crt; bring back the two that were made together");
  }
  return std::unique_ptr<Authority>(new Authority(std::move(handles), credentials));
}

absl::StatusOr<Credentials> Authority::Issue(const Profile& profile, int days) const {
  absl::StatusOr<Key> key = NewKey();
  if (!key.ok()) return key.status();
  absl::StatusOr<Certificate> made = Blank(key->get(), days);
  if (!made.ok()) return made.status();
  X509* const certificate = made->get();
  X509* const issuer = handles_->certificate.get();
  X509_NAME* const name = X509_get_subject_name(certificate);
  const std::string names = Joined(profile.alternative_names);
  if (!AddNamePart(name, "O", profile.organization) ||
      !AddNamePart(name, "OU", profile.organizational_unit) ||
      !AddNamePart(name, "CN", profile.common_name) ||
      X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) != 1 ||
      !AddExtension(certificate, issuer, NID_basic_constraints, "critical,CA:FALSE") ||
      !AddExtension(certificate, issuer, NID_key_usage, "critical,digitalSignature") ||
      !AddExtension(certificate, issuer, NID_ext_key_usage,
                    profile.server ? "serverAuth" : "clientAuth") ||
      !AddExtension(certificate, issuer, NID_subject_key_identifier, "hash") ||
      !AddExtension(certificate, issuer, NID_authority_key_identifier, "keyid") ||
      (!names.empty() && !AddExtension(certificate, issuer, NID_subject_alt_name, names)) ||
      X509_sign(certificate, handles_->key.get(), EVP_sha256()) == 0) {
    return Failed("a certificate");
  }
  // A server judges what robots show: the certificate, and what signed it behind it.
  if (!profile.server) {
    if (absl::Status shown = CheckShown({ToDer(certificate), ToDer(issuer)}); !shown.ok()) {
      return shown;
    }
  }
  return Credentials{ToPem(certificate), ToPem(key->get())};
}

}  // namespace uplink::pki
