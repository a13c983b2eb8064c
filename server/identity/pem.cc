#include "server/identity/pem.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

namespace uplink::identity {

void BioFree::operator()(BIO* bio) const { BIO_free(bio); }
void X509Free::operator()(X509* certificate) const { X509_free(certificate); }
void KeyFree::operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }

Bio PemReader(std::string_view text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Certificate NextCertificate(BIO* reader) {
  // An empty pass phrase: without one the library would ask the terminal.
  char no_phrase[] = "";
  return Certificate(PEM_read_bio_X509_AUX(reader, nullptr, nullptr, no_phrase));
}

Key ReadKey(std::string_view text) {
  char no_phrase[] = "";
  return Key(PEM_read_bio_PrivateKey(PemReader(text).get(), nullptr, nullptr, no_phrase));
}

bool UseChain(SSL_CTX* context, std::string_view text) {
  const Bio reader = PemReader(text);
  const Certificate leaf = NextCertificate(reader.get());
  if (leaf == nullptr || SSL_CTX_use_certificate(context, leaf.get()) != 1) return false;
  while (const Certificate next = NextCertificate(reader.get())) {
    if (SSL_CTX_add1_chain_cert(context, next.get()) != 1) return false;
  }
  return true;
}

bool UseKey(SSL_CTX* context, std::string_view text) {
  const Key key = ReadKey(text);
  return key != nullptr && SSL_CTX_use_PrivateKey(context, key.get()) == 1;
}

}  // namespace uplink::identity
