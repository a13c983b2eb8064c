#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

#include "schema/base/clock.h"

namespace uplink::front {

/// Longest path that is looked up; a longer one is none of our methods.
inline constexpr std::size_t kPathBytesMax = 256;

/// Reads `grpc-timeout`: at most 8 digits and a unit; empty if it is invalid (Source: gRPC over
/// HTTP/2, Requests). A timeout under a millisecond is one millisecond.
[[nodiscard]] std::optional<milliseconds> ParseTimeout(std::string_view text);

/// The headers of one request, as they arrive, and whether they are gRPC's. Confined to its
/// connection's thread.
class RequestHead final {
 public:
  /// False once the headers are over kHeaderBytesMax; the rest is not kept.
  bool Add(std::string_view name, std::string_view value);

  /// The HTTP status for a request that is not gRPC (405, 415); empty for a gRPC request.
  [[nodiscard]] std::optional<int> NotGrpc() const;
  /// What is wrong with a gRPC request, apart from its method.
  ///
  /// Errors: kResourceExhausted for headers past their limit; kUnimplemented for an encoding;
  ///         kInvalidArgument for a timeout that is none; kInternal for a request without
  ///         `te: trailers`: a proxy has dropped headers.
  [[nodiscard]] absl::Status Judge() const;
  /// Whether we do not support the encoding: the answer then names those that we do.
  [[nodiscard]] bool foreign_encoding() const { return !encoding_.empty(); }

  [[nodiscard]] const std::string& path() const { return path_; }
  /// The metadata `authorization`; empty: there is none. It is not logged.
  [[nodiscard]] std::string TakeAuthorization() { return std::move(authorization_); }
  [[nodiscard]] std::optional<milliseconds> timeout() const { return timeout_; }

 private:
  std::uint32_t bytes_ = 0;
  bool too_large_ = false;
  bool is_post_ = false;
  bool is_grpc_ = false;
  bool takes_trailers_ = false;
  bool bad_timeout_ = false;
  std::string path_;
  std::string authorization_;
  /// Anything but identity.
  std::string encoding_;
  std::optional<milliseconds> timeout_;
};

}  // namespace uplink::front
