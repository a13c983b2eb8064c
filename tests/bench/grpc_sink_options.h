#pragma once

#include <memory>
#include <string>

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

namespace uplink::bench {

// What the bare gRPC sink is told, so that it serves as the relay does: mutual TLS without session
// tickets, the same windows and bounds.

/// `folder` holds server.crt, server.key and ca.crt.
[[nodiscard]] std::shared_ptr<grpc::ServerCredentials> MutualTls(const std::string& folder);

void SetChannelArguments(grpc::ServerBuilder& builder);

/// For the whole process: gRPC 1.51 has no setter, but reads OpenSSL's own configuration. Before
/// anything else of OpenSSL is used.
void SendNoSessionTickets();

}  // namespace uplink::bench
