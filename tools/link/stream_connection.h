#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::link {

/// How a stream ended: gRPC's code, 0 to 16, and the server's words. A value.
struct StreamEnd {
  int code = 0;
  std::string message;
};
inline constexpr int kCodeOk = 0;
inline constexpr int kCodeCancelled = 1;
inline constexpr int kCodeUnknown = 2;
inline constexpr int kCodeInvalidArgument = 3;
inline constexpr int kCodePermissionDenied = 7;
inline constexpr int kCodeResourceExhausted = 8;
inline constexpr int kCodeUnimplemented = 12;
inline constexpr int kCodeInternal = 13;
inline constexpr int kCodeUnavailable = 14;
inline constexpr int kCodeUnauthenticated = 16;

/// What a connection tells its owner: on the loop's thread, never from within a call that the owner
/// makes. Only within OnEnded may the owner drop the connection.
class StreamEvents {
 public:
  virtual ~StreamEvents() = default;
  /// The connection is up: OpenStream may be called.
  virtual void OnConnected() = 0;
  virtual void OnMessage(std::string_view message) = 0;
  /// The kernel has taken all that waited.
  virtual void OnSent() = 0;
  /// The stream, or the connection before a stream was opened, is over. Called once per stream.
  virtual void OnEnded(const StreamEnd& end) = 0;
};

/// A connection with one bidirectional gRPC stream at a time.
///
/// Thread: confined to the loop's thread.
class StreamConnection {
 public:
  virtual ~StreamConnection() = default;

  virtual void Connect() = 0;
  /// From now on another owner gets the events.
  virtual void SetEvents(StreamEvents& events) = 0;
  /// Opens a stream of this method (`/package.Service/Method`). False if one is open or the
  /// connection takes none.
  virtual bool OpenStream(const std::string& path) = 0;
  /// Sends one message. Only while a stream is open and not half-closed.
  virtual void Send(std::string_view message) = 0;
  /// Nothing more is sent after this; the server then ends the stream.
  virtual void HalfClose() = 0;
  /// RST_STREAM; OnEnded says CANCELLED.
  virtual void CancelStream() = 0;

  /// Another stream can be opened on it.
  [[nodiscard]] virtual bool usable() const = 0;
  /// Bytes of messages that wait for the server, or for the kernel.
  [[nodiscard]] virtual std::size_t unsent() const = 0;
  /// A slow reader: nothing is read until it is called with false.
  virtual void PauseReading(bool pause) = 0;
  /// Delays the writes that follow.
  virtual void SetDelay(milliseconds delay) = 0;
  /// Half-open: nothing leaves, nothing is read, and the peer is told nothing. No event comes.
  virtual void Freeze() = 0;
  /// Ends it at once. No event comes.
  virtual void Cut() = 0;
};

}  // namespace uplink::link
