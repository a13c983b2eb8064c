#pragma once

#include <absl/status/status.h>
#include <grpcpp/support/status.h>

namespace uplink::relay {

/// The status as gRPC sends it; the one place where the two are mapped.
[[nodiscard]] grpc::Status ToGrpc(const absl::Status& status);

}  // namespace uplink::relay
