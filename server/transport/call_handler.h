#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "server/identity/peer_identity.h"
#include "server/loop/wake.h"
#include "server/transport/end_cause.h"
#include "server/transport/peer_connection.h"

namespace uplink::transport {

/// Bytes before each message: a flag, and the message's length (Source: gRPC over HTTP/2).
inline constexpr std::size_t kPrefixBytes = 5;

/// Writes the prefix of an uncompressed message of so many bytes.
inline void PutPrefix(std::size_t bytes, char* into) {
  into[0] = '\0';
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    into[i] = static_cast<char>((bytes >> (8 * (kPrefixBytes - 1 - i))) & 0xFFU);
  }
}

/// A protobuf message with its prefix, as it is sent. A message that does not serialize is our bug.
template <typename Message>
[[nodiscard]] std::string WithPrefix(const Message& message) {
  const std::size_t bytes = message.ByteSizeLong();
  std::string text(kPrefixBytes + bytes, '\0');
  PutPrefix(bytes, text.data());
  const bool done = message.SerializeToArray(text.data() + kPrefixBytes, static_cast<int>(bytes));
  UPLINK_CHECK(done, "a message of ours does not serialize");
  return text;
}

/// What a caller has shown of itself, for methods that judge their callers (Method::open). A value.
struct CallerProof {
  /// Of its connection's certificate; nothing: it showed none. Not OK: what is wrong with that.
  std::optional<absl::StatusOr<identity::PeerIdentity>> identity{};
  /// What logs call the certificate's holder, and when the first of its chain expires.
  std::string subject{};
  SystemTime expiry{};
  /// The metadata `authorization`; empty: there is none.
  std::string authorization{};
  /// Where it comes from, as SourceAddress says; for the log.
  std::array<std::uint8_t, 16> source{};
  std::string from{};
};

/// A message that several calls send, without its prefix. Immutable.
using SharedMessage = std::shared_ptr<const std::string>;

/// One gRPC call as its handler sees it: who calls, and what the handler may ask for. It outlives
/// its handler.
///
/// Thread: confined to its connection's.
class ServedCall {
 public:
  virtual ~ServedCall() = default;
  /// Requests the next message. One call of the handler answers later.
  virtual void RequestMessage() = 0;
  /// Writes one message with its prefix, or several shared ones in order; at most one write is
  /// under way.
  virtual void Write(std::string message_with_prefix) = 0;
  virtual void Write(std::vector<SharedMessage> messages) = 0;
  /// Ends the call, after a write under way.
  virtual void Finish(const absl::Status& status) = 0;
  /// The same, and logs who was refused, and why.
  virtual void FinishRefused(const absl::Status& status) = 0;
  /// Ends it at once.
  virtual void Cancel() = 0;
  /// Asks whether the peer is there. If it answers, the handler's OnPeerAnswered is called.
  virtual void AskPeer() = 0;
  /// Who calls; it may call the method. Not of an open method.
  [[nodiscard]] virtual const identity::PeerIdentity& peer() const = 0;
  /// What the caller has shown; while an open method's `serve` runs.
  [[nodiscard]] virtual CallerProof proof() const { return {}; }
  /// Its caller has shown a token: its connection counts as this caller's from then on, unless it
  /// has a certificate. `name`: of the token.
  virtual void NoteCaller(std::string_view /*name*/) {}
  /// The connection that it came by; null where there is no wire, as in simulation.
  [[nodiscard]] virtual PeerConnection* connection() { return nullptr; }
  /// The caller's deadline (grpc-timeout), at which the call ends by itself (Method::at_deadline).
  [[nodiscard]] virtual std::optional<SteadyTime> give_up_at() const = 0;
  /// For other threads, which cause the handler's OnWake by it.
  [[nodiscard]] virtual loop::StreamRef self() const = 0;
};

/// Serves one call. After the handler has called Finish or Cancel, the call calls only OnBroken.
/// The call destroys it, never from within one of the handler's own calls.
///
/// Thread: confined to its connection's.
class CallHandler {
 public:
  virtual ~CallHandler() = default;
  virtual void Start() = 0;
  /// Bytes of the largest message that it takes next; read at each RequestMessage.
  [[nodiscard]] virtual std::uint64_t message_bytes_max() const = 0;
  // Exactly one of the next three, or OnBroken, answers each RequestMessage, after it has
  // returned.
  virtual void OnMessage(std::string_view bytes) = 0;
  /// The peer announced a message over message_bytes_max, which is not kept.
  virtual void OnTooLarge(std::uint64_t bytes) = 0;
  virtual void OnHalfClose() = 0;
  /// Bytes came of the message that it waits for, which is still incomplete.
  virtual void OnMessageBytes() {}
  /// The peer answered AskPeer.
  virtual void OnPeerAnswered() {}
  /// Nothing more can be sent. Idempotent.
  virtual void OnBroken(const Ending& ending) = 0;
  /// The transport has taken the write under way.
  virtual void OnWritten() = 0;
  virtual void OnWake() = 0;
  virtual void OnTimer() = 0;
  /// When OnTimer is due.
  [[nodiscard]] virtual std::optional<SteadyTime> deadline() const = 0;
  /// The server drains, or the connection has reached its age: the handler settles what it took
  /// within `grace`.
  virtual void OnDrain(milliseconds grace) = 0;
};

}  // namespace uplink::transport
