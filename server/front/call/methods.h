#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/identity/peer_identity.h"
#include "server/transport/call_handler.h"

namespace uplink::front {

class Call;

/// How many messages each side of a method sends.
enum class MethodKind : std::uint8_t { kUnary, kServerStream, kBidirectional };

/// One method of a service: how it is called, and what serves a call of it.
struct Method {
  MethodKind kind = MethodKind::kUnary;
  /// Whose certificates may call it, and the same in words for those that may not.
  std::vector<identity::Role> roles;
  std::string_view audience;
  /// Errors: the call ends with them, before it has begun.
  std::function<absl::StatusOr<std::unique_ptr<transport::CallHandler>>(Call&)> serve;
};

/// The methods that are served, by path. Immutable once the first connection comes.
using Methods = std::map<std::string, Method, std::less<>>;

/// Whether this peer may call the method of this path.
///
/// Errors: kUnauthenticated with one sentence: what the certificate lacks, or that it is of a role
///         that may not call this; of a path that is no method's, of one that may call nothing.
[[nodiscard]] absl::Status MayCall(const absl::StatusOr<identity::PeerIdentity>& identity,
                                   const Methods& methods, std::string_view path);

}  // namespace uplink::front
