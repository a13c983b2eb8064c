#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "server/identity/peer_identity.h"
#include "server/loop/wake.h"

namespace uplink::transport {

/// Bytes before each message: a flag, and the message's length (Source: gRPC over HTTP/2).
inline constexpr std::size_t kPrefixBytes = 5;

/// Writes what goes before a message: it is not compressed, and so many bytes long.
inline void PutPrefix(std::size_t bytes, char* into) {
  into[0] = '\0';
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    into[i] = static_cast<char>((bytes >> (8 * (kPrefixBytes - 1 - i))) & 0xFFU);
  }
}

/// A message of protobuf as it goes out. `message` serializes: all of ours do.
template <typename Message>
[[nodiscard]] std::string WithPrefix(const Message& message) {
  const std::size_t bytes = message.ByteSizeLong();
  std::string text(kPrefixBytes + bytes, '\0');
  PutPrefix(bytes, text.data());
  const bool done = message.SerializeToArray(text.data() + kPrefixBytes, static_cast<int>(bytes));
  UPLINK_CHECK(done, "a message of ours does not serialize");
  return text;
}

/// A message that several calls send, without its prefix. Immutable.
using SharedMessage = std::shared_ptr<const std::string>;

/// One gRPC call as its handler sees it: whose it is, and what may be asked of it. It outlives its
/// handler.
///
/// Thread: confined to its connection's.
class ServedCall {
 public:
  virtual ~ServedCall() = default;
  /// The next message, please: answered by one call of the handler, later.
  virtual void RequestMessage() = 0;
  /// One message with its prefix, or several that are shared, one after the other; at most one
  /// write is under way.
  virtual void Write(std::string message_with_prefix) = 0;
  virtual void Write(std::vector<SharedMessage> messages) = 0;
  /// Ends the call, after a write under way.
  virtual void Finish(const absl::Status& status) = 0;
  /// The same, and a line says who was refused, and why.
  virtual void FinishRefused(const absl::Status& status) = 0;
  /// Ends it at once.
  virtual void Cancel() = 0;
  /// Asks whether the peer is there: answered by the handler's OnPeerAnswered, if it ever is.
  virtual void AskPeer() = 0;
  /// Who calls: somebody who may call the method.
  [[nodiscard]] virtual const identity::PeerIdentity& peer() const = 0;
  /// When the time that the caller gave is over: the call then ends by itself, as its method says.
  [[nodiscard]] virtual std::optional<SteadyTime> give_up_at() const = 0;
  /// By this any thread has the handler's OnWake called.
  [[nodiscard]] virtual loop::StreamRef self() const = 0;
};

/// What serves one call. The call asks it nothing any more once it has called Finish or Cancel,
/// except OnBroken; it is destroyed by its call, never from within a call of its own.
///
/// Thread: confined to its connection's.
class CallHandler {
 public:
  virtual ~CallHandler() = default;
  virtual void Start() = 0;
  /// Bytes of the largest message that it takes next, asked at each RequestMessage.
  [[nodiscard]] virtual std::uint64_t message_bytes_max() const = 0;
  // Exactly one of the next three, or OnBroken, answers each RequestMessage, after it has
  // returned.
  virtual void OnMessage(std::string_view bytes) = 0;
  /// The peer announced a message over message_bytes_max; nothing of it is kept.
  virtual void OnTooLarge(std::uint64_t bytes) = 0;
  virtual void OnHalfClose() = 0;
  /// Bytes came of the message that it waits for, and it is not whole.
  virtual void OnMessageBytes() {}
  /// The peer answered AskPeer.
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

}  // namespace uplink::transport
