#include "server/relay/credentials.h"

#include <utility>
#include <vector>

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include "server/transport/key_files.h"

namespace uplink::relay {
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MutualTls(
    const transport::KeyMaterial& material) {
  namespace tls = grpc::experimental;
  std::shared_ptr<tls::CertificateProviderInterface> provider;
  if (const auto* files = std::get_if<transport::PemFiles>(&material)) {
    provider = std::make_shared<tls::FileWatcherCertificateProvider>(
        files->key, files->certificate, files->client_ca,
        static_cast<unsigned int>(transport::kFilesRefresh.count()));
  } else {
    const auto& texts = std::get<transport::PemTexts>(material);
    if (const absl::Status status = transport::CheckTexts(texts); !status.ok()) return status;
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
