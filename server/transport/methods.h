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

#include "schema/base/clock.h"
#include "server/identity/peer_identity.h"
#include "server/transport/call_handler.h"
#include "server/transport/gate.h"

namespace uplink::transport {

/// How many messages each side of a method sends.
enum class MethodKind : std::uint8_t { kUnary, kServerStream, kBidirectional };

/// One method of a service: how it is called, and what serves a call of it.
struct Method {
  MethodKind kind = MethodKind::kUnary;
  /// Whose certificates may call it, and the same in words for those that may not.
  std::vector<identity::Role> roles;
  std::string_view audience;
  /// In which bounds of the gate a call of it counts.
  Admission admission = Admission::kStream;
  /// How a call ends whose grpc-timeout is over.
  absl::Status at_deadline = absl::DeadlineExceededError("the time that grpc-timeout gave is over");
  /// Of a call that was admitted. Errors: the call ends with them, before it has begun.
  std::function<absl::StatusOr<std::unique_ptr<CallHandler>>(ServedCall&)> serve;
};

/// The methods that are served, by path. Immutable once the first connection comes.
using Methods = std::map<std::string, Method, std::less<>>;

/// Makes the methods of one thread, once, before it serves: what they hold is confined to it.
/// `clock` is the thread's, and outlives them.
using MethodsMaker = std::function<Methods(const Clock& clock)>;

/// Whether this peer may call the method of this path.
///
/// Errors: kUnauthenticated with one sentence: what the certificate lacks, or that it is of a role
///         that may not call this; of a path that is no method's, of one that may call nothing.
[[nodiscard]] absl::Status MayCall(const absl::StatusOr<identity::PeerIdentity>& identity,
                                   const Methods& methods, std::string_view path);

}  // namespace uplink::transport
