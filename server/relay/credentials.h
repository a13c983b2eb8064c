#pragma once

#include <memory>

#include <absl/status/statusor.h>
#include <grpcpp/security/server_credentials.h>

#include "server/transport/options.h"

namespace uplink::relay {

/// Mutual TLS, always: every client must show a certificate that the client authority signed.
///
/// Files are those of ServedFiles, which are good together.
///
/// Errors:  kFailedPrecondition names the text that does not parse, or the key that does not belong
///          to the certificate: gRPC itself would start and then fail each handshake without a
///          word.
[[nodiscard]] absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MutualTls(
    const transport::KeyMaterial& material);

}  // namespace uplink::relay
