#include "server/identity/pem.h"

#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

namespace uplink::identity {
namespace {

absl::Status Lacks(const NamedPem& pem, std::string_view what) {
  return absl::FailedPreconditionError(
      fmt::format("{}: holds no PEM {}; name the file that does", pem.name, what));
}

/// Null if it cannot be read.
Certificate CertificateIn(const NamedPem& pem, const PemBlock& block) {
  // An empty pass phrase, here and below: without one the library would ask the terminal.
  char no_phrase[] = "";
  Certificate certificate(
      PEM_read_bio_X509_AUX(PemReader(TextOf(pem, block)).get(), nullptr, nullptr, no_phrase));
  ERR_clear_error();
  return certificate;
}

/// The block of the first private key, null if there is none; further keys get a flaw.
PemBlock* KeyBlockOf(std::vector<PemBlock>& blocks) {
  PemBlock* found = nullptr;
  for (PemBlock& block : blocks) {
    if (!block.flaw.empty()) continue;
    if (block.kind == PemKind::kEncryptedKey) {
      block.flaw =
          "is a private key behind a pass phrase, and the server asks for none: write it without "
          "one (openssl pkey -in FILE)";
    } else if (block.kind == PemKind::kKey && found != nullptr) {
      block.flaw = fmt::format("is a second private key: block {} is one already; keep one of them",
                               found->number);
    } else if (block.kind == PemKind::kKey) {
      found = &block;
    }
  }
  return found;
}

}  // namespace

void BioFree::operator()(BIO* bio) const { BIO_free(bio); }
void X509Free::operator()(X509* certificate) const { X509_free(certificate); }
void KeyFree::operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }

Bio PemReader(std::string_view text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

absl::StatusOr<std::vector<Certificate>> ReadCertificates(const NamedPem& pem) {
  return ReadCertificates(pem, [](X509*) { return std::string(); });
}

absl::StatusOr<std::vector<Certificate>> ReadCertificates(const NamedPem& pem,
                                                          CertificateJudge judge) {
  auto blocks = BlocksOf(pem);
  if (!blocks.ok()) return blocks.status();
  std::vector<Certificate> certificates;
  for (PemBlock& block : *blocks) {
    if (!block.flaw.empty() || block.kind != PemKind::kCertificate) continue;
    certificates.push_back(CertificateIn(pem, block));
    block.flaw = certificates.back() == nullptr ? "is broken: it is no certificate that can be read"
                                                : judge(certificates.back().get());
  }
  if (absl::Status good = CheckBlocks(pem, *blocks); !good.ok()) return good;
  if (certificates.empty()) return Lacks(pem, "certificate");
  return certificates;
}

absl::StatusOr<Key> ReadKey(const NamedPem& pem) {
  auto blocks = BlocksOf(pem);
  if (!blocks.ok()) return blocks.status();
  PemBlock* const block = KeyBlockOf(*blocks);
  if (absl::Status good = CheckBlocks(pem, *blocks); !good.ok()) return good;
  if (block == nullptr) return Lacks(pem, "private key");
  char no_phrase[] = "";
  Key key(
      PEM_read_bio_PrivateKey(PemReader(TextOf(pem, *block)).get(), nullptr, nullptr, no_phrase));
  ERR_clear_error();
  if (key != nullptr) return key;
  block->flaw = "is broken: it is no private key that can be read";
  return CheckBlocks(pem, *blocks);
}

bool UseChain(SSL_CTX* context, std::string_view text) {
  const auto certificates = ReadCertificates({"", std::string(text)});
  if (!certificates.ok()) return false;
  if (SSL_CTX_use_certificate(context, certificates->front().get()) != 1) return false;
  for (std::size_t i = 1; i < certificates->size(); ++i) {
    if (SSL_CTX_add1_chain_cert(context, (*certificates)[i].get()) != 1) return false;
  }
  return true;
}

bool UseKey(SSL_CTX* context, std::string_view text) {
  const auto key = ReadKey({"", std::string(text)});
  return key.ok() && SSL_CTX_use_PrivateKey(context, key->get()) == 1;
}

}  // namespace uplink::identity
