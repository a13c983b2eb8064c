#pragma once

#include <grpcpp/server_builder.h>

#include "server/relay/options.h"

namespace uplink::relay {

/// Sets every limit of the listener that gRPC would otherwise choose.
void SetChannelArguments(const RelayOptions& options, const session::SessionLimits& limits,
                         grpc::ServerBuilder& builder);

}  // namespace uplink::relay
