#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <absl/status/status.h>

namespace uplink::front {

/// The number of `grpc-status`. Abseil's codes are gRPC's.
[[nodiscard]] int GrpcCode(absl::StatusCode code);

/// The text as `grpc-message` carries it: percent-encoded but for printable ASCII (Source: gRPC
/// over HTTP/2, Responses).
[[nodiscard]] std::string PercentEncoded(std::string_view text);

/// The gRPC status that a reset with this HTTP/2 code means (Source: gRPC over HTTP/2, Errors).
[[nodiscard]] absl::StatusCode CodeOfReset(std::uint32_t http2_code);

}  // namespace uplink::front
