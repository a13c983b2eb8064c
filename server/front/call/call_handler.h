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

namespace uplink::front {

class Call;

/// What serves one call. The call asks it nothing any more once it has called Call::Finish or
/// Call::Cancel, except OnBroken; it is destroyed by its call, never from within a call of its own.
///
/// Thread: confined to its connection's.
class CallHandler {
 public:
  virtual ~CallHandler() = default;
  virtual void Start() = 0;
  /// Bytes of the largest message that it takes next, asked at each Call::RequestMessage.
  [[nodiscard]] virtual std::uint64_t message_bytes_max() const = 0;
  // Exactly one of the next three, or OnBroken, answers each Call::RequestMessage, after it has
  // returned.
  virtual void OnMessage(std::string_view bytes) = 0;
  /// The peer announced a message over message_bytes_max; nothing of it is kept.
  virtual void OnTooLarge(std::uint64_t bytes) = 0;
  virtual void OnHalfClose() = 0;
  /// Bytes came of the message that it waits for, and it is not whole.
  virtual void OnMessageBytes() {}
  /// The peer answered Call::AskPeer.
  virtual void OnPeerAnswered() {}
  /// Nothing can be said any more: the peer reset the stream and meant this code, or the call ends
  /// with it by no wish of its handler; none: the connection is gone. Idempotent.
  virtual void OnBroken(std::optional<absl::StatusCode> code) = 0;
  /// The write under way was taken.
  virtual void OnWritten() = 0;
  virtual void OnWake() = 0;
  virtual void OnTimer() = 0;
  /// When OnTimer wants to be called.
  [[nodiscard]] virtual std::optional<SteadyTime> deadline() const = 0;
  /// The server drains, or the connection has its age: what was taken is settled within `grace`.
  virtual void OnDrain(milliseconds grace) = 0;
};

/// How many messages each side of a method sends.
enum class MethodKind : std::uint8_t { kUnary, kServerStream, kBidirectional };

/// One method of a service: how it is called, and what serves a call of it.
struct Method {
  MethodKind kind = MethodKind::kUnary;
  /// Whose certificates may call it, and the same in words for those that may not.
  std::vector<identity::Role> roles;
  std::string_view audience;
  /// Errors: the call ends with them, before it has begun.
  std::function<absl::StatusOr<std::unique_ptr<CallHandler>>(Call&)> serve;
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
