#pragma once

#include <grpcpp/server_builder.h>

#include "server/transport/options.h"

namespace uplink::relay {

/// Sets every limit of the listener that gRPC would otherwise choose.
void SetChannelArguments(const transport::RelayOptions& options,
                         const session::SessionLimits& limits, grpc::ServerBuilder& builder);

}  // namespace uplink::relay
