#include "server/relay/credentials.h"

#include <utility>
#include <vector>

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include "server/identity/authorities.h"
#include "server/identity/server_pair.h"

namespace uplink::relay {
namespace {

using identity::NamedPem;

absl::Status CheckTexts(const PemTexts& texts) {
  if (absl::Status status =
          identity::CheckAuthorities(NamedPem{"the client authority", texts.client_ca});
      !status.ok()) {
    return status;
  }
  return identity::CheckServerPair({"the certificate", texts.certificate}, {"the key", texts.key});
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MutualTls(const KeyMaterial& material) {
  namespace tls = grpc::experimental;
  std::shared_ptr<tls::CertificateProviderInterface> provider;
  if (const auto* files = std::get_if<PemFiles>(&material)) {
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
