#include "tests/support/pem_texts.h"

#include <memory>

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

struct BioFree {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
struct KeyFree {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, BioFree>;
using Key = std::unique_ptr<EVP_PKEY, KeyFree>;

void Require(bool done) { UPLINK_CHECK(done, "OpenSSL refused to write a test key"); }

Key KeyOf(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, nullptr, nullptr));
  Require(key != nullptr);
  return key;
}

std::string TextOf(BIO* bio) {
  char* data = nullptr;
  const auto size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(size)};
}

/// In OpenSSL's own form, by `cipher` if there is one.
std::string OwnForm(const std::string& key_pem, const EVP_CIPHER* cipher) {
  const Bio out(BIO_new(BIO_s_mem()));
  unsigned char phrase[] = "phrase";
  Require(PEM_write_bio_PrivateKey_traditional(
              out.get(), KeyOf(key_pem).get(), cipher, cipher != nullptr ? phrase : nullptr,
              cipher != nullptr ? sizeof(phrase) - 1 : 0, nullptr, nullptr) == 1);
  return TextOf(out.get());
}

}  // namespace

std::string EcparamKey(const std::string& key_pem) {
  // The object identifier of P-256.
  return BlockOf("EC PARAMETERS", "BggqhkjOPQMBBw==\n") + OwnForm(key_pem, nullptr);
}

std::string LockedKey(const std::string& key_pem) {
  const Bio out(BIO_new(BIO_s_mem()));
  const std::string phrase = "phrase";
  Require(PEM_write_bio_PKCS8PrivateKey(out.get(), KeyOf(key_pem).get(), EVP_aes_128_cbc(),
                                        phrase.data(), static_cast<int>(phrase.size()), nullptr,
                                        nullptr) == 1);
  return TextOf(out.get());
}

std::string LockedOwnKey(const std::string& key_pem) { return OwnForm(key_pem, EVP_aes_128_cbc()); }

std::string WithCrlf(const std::string& text) {
  std::string lines;
  for (const char c : text) lines += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return lines;
}

std::string With(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  UPLINK_CHECK(at != std::string::npos, "a test's text has what it replaces");
  return text.replace(at, from.size(), to);
}

std::string BlockOf(const std::string& label, const std::string& body) {
  return "-----BEGIN " + label + "-----\n" + body + "-----END " + label + "-----\n";
}

}  // namespace uplink::testing
