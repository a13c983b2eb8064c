#include "server/relay/credentials.h"

#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <climits>
#include <fmt/format.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

namespace uplink::relay {
namespace {

/// Bytes of the largest PEM file that is read: some thousand certificates.
constexpr std::size_t kPemBytesMax = std::size_t{4} * 1024 * 1024;

struct BioFree {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
struct X509Free {
  void operator()(X509* certificate) const { X509_free(certificate); }
};
struct KeyFree {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, BioFree>;
using Certificate = std::unique_ptr<X509, X509Free>;
using Key = std::unique_ptr<EVP_PKEY, KeyFree>;

/// One PEM text and how a sentence names it.
struct Pem {
  std::string name;
  std::string text;
};

Bio Reader(const Pem& pem) {
  return Bio(BIO_new_mem_buf(pem.text.data(), static_cast<int>(pem.text.size())));
}

absl::StatusOr<Certificate> ParseCertificate(const Pem& pem) {
  Certificate certificate(PEM_read_bio_X509(Reader(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (certificate == nullptr) {
    return absl::FailedPreconditionError(fmt::format("{}: holds no PEM certificate", pem.name));
  }
  return certificate;
}

absl::Status CheckPair(const Pem& certificate_pem, const Pem& key_pem) {
  const auto certificate = ParseCertificate(certificate_pem);
  if (!certificate.ok()) return certificate.status();
  // An empty pass phrase: without one the library would ask the terminal.
  char no_phrase[] = "";
  const Key key(PEM_read_bio_PrivateKey(Reader(key_pem).get(), nullptr, nullptr, no_phrase));
  ERR_clear_error();
  if (key == nullptr) {
    return absl::FailedPreconditionError(
        fmt::format("{}: holds no PEM private key without a pass phrase", key_pem.name));
  }
  const bool match = X509_check_private_key(certificate->get(), key.get()) == 1;
  ERR_clear_error();
  if (!match) {
    return absl::FailedPreconditionError(
        fmt::format("{}: is not the key of {}", key_pem.name, certificate_pem.name));
  }
  return absl::OkStatus();
}

absl::StatusOr<Pem> ReadPem(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::FailedPreconditionError(fmt::format("{}: cannot be read", path));
  std::string text(kPemBytesMax, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return Pem{path, std::move(text)};
}

absl::Status CheckFiles(const PemFiles& files) {
  const auto certificate = ReadPem(files.certificate);
  if (!certificate.ok()) return certificate.status();
  const auto key = ReadPem(files.key);
  if (!key.ok()) return key.status();
  const auto client_ca = ReadPem(files.client_ca);
  if (!client_ca.ok()) return client_ca.status();
  if (const auto parsed = ParseCertificate(*client_ca); !parsed.ok()) return parsed.status();
  return CheckPair(*certificate, *key);
}

absl::Status CheckTexts(const PemTexts& texts) {
  const auto client_ca = ParseCertificate({"the client authority", texts.client_ca});
  if (!client_ca.ok()) return client_ca.status();
  return CheckPair({"the certificate", texts.certificate}, {"the key", texts.key});
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MutualTls(const KeyMaterial& material) {
  namespace tls = grpc::experimental;
  std::shared_ptr<tls::CertificateProviderInterface> provider;
  if (const auto* files = std::get_if<PemFiles>(&material)) {
    if (const absl::Status status = CheckFiles(*files); !status.ok()) return status;
    provider = std::make_shared<tls::FileWatcherCertificateProvider>(
        files->key, files->certificate, files->client_ca,
        static_cast<unsigned int>(kFilesRefresh.count()));
  } else {
    const auto& texts = std::get<PemTexts>(material);
    if (const absl::Status status = CheckTexts(texts); !status.ok()) return status;
    provider = std::make_shared<tls::StaticDataCertificateProvider>(
        texts.client_ca, std::vector<tls::IdentityKeyCertPair>{{texts.key, texts.certificate}});
  }
  tls::TlsServerCredentialsOptions options(std::move(provider));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  return tls::TlsServerCredentials(options);
}

}  // namespace uplink::relay
