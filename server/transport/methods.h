#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
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

/// One method of a service: who may call it, and what serves a call.
struct Method {
  MethodKind kind = MethodKind::kUnary;
  /// The roles that may call it, and the same in words for those that may not.
  std::vector<identity::Role> roles{};
  std::string_view audience{};
  /// Anyone may call it, also without a certificate: `serve` judges by ServedCall::proof.
  bool open = false;
  /// The gate's bounds in which a call of it counts.
  Admission admission = Admission::kStream;
  /// The status of a call at its deadline (grpc-timeout).
  absl::Status at_deadline = absl::DeadlineExceededError("the time that grpc-timeout gave is over");
  /// Makes the handler of an admitted call. Errors: the call ends with them before it has begun.
  std::function<absl::StatusOr<std::unique_ptr<CallHandler>>(ServedCall&)> serve;
  /// Called once at each call's end, if set: with its code, or nothing if it broke off without one.
  std::function<void(std::optional<absl::StatusCode>)> ended{};
};

/// The methods that are served, by path. Immutable once the first connection comes.
using Methods = std::map<std::string, Method, std::less<>>;

/// Makes the methods of one thread, once, before it serves: what they hold is confined to the
/// thread. `clock` is the thread's, and outlives them.
using MethodsMaker = std::function<Methods(const Clock& clock)>;

/// Whether this peer may call the method of this path. What is open is not judged here; beside it,
/// an unknown path is no secret.
///
/// Errors: kUnauthenticated with one sentence: what the certificate lacks, or that its role may not
///         call this; for an unknown path, that its role may call no method at all.
[[nodiscard]] absl::Status MayCall(const absl::StatusOr<identity::PeerIdentity>& identity,
                                   const Methods& methods, std::string_view path);

}  // namespace uplink::transport
