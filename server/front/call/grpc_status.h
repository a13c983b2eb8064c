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

/// What a peer that resets a stream with an HTTP/2 code says in gRPC's words (Source: gRPC over
/// HTTP/2, Errors).
[[nodiscard]] absl::StatusCode CodeOfReset(std::uint32_t http2_code);

}  // namespace uplink::front
