#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tools/link/http2_link.h"
#include "tools/link/tls_link.h"

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

/// Messages of a server longer than that end the stream.
inline constexpr std::size_t kMessageBytesMax = 4 * 1024 * 1024;

/// A connection of its own, or a part in one that others use too, with one bidirectional gRPC
/// stream at a time, for programs that open thousands. It has no retries, name resolution or load
/// balancing, as gRPC's own library does.
///
/// Thread: confined to the loop's thread.
/// Source: "gRPC over HTTP2", the protocol's own description.
class GrpcConnection final : private LinkUser, private Http2Events {
 public:
  GrpcConnection(Loop& loop, LinkOptions options, StreamEvents& events);
  /// A part in this link.
  GrpcConnection(std::shared_ptr<Http2Link> link, std::string authority, StreamEvents& events);
  /// Closes the connection in an orderly way, or of a link that others use its stream.
  ~GrpcConnection() override;
  GrpcConnection(const GrpcConnection&) = delete;
  GrpcConnection& operator=(const GrpcConnection&) = delete;

  void Connect() { link_->Connect(); }
  /// From now on another owner gets the events.
  void SetEvents(StreamEvents& events) { events_ = &events; }
  /// Opens a stream of this method (`/package.Service/Method`). False if one is open or the
  /// connection takes none.
  bool OpenStream(const std::string& path);
  /// Sends one message. Only while a stream is open and not half-closed.
  void Send(std::string_view message);
  /// Nothing more is sent after this; the server then ends the stream.
  void HalfClose();
  /// RST_STREAM; OnEnded says CANCELLED.
  void CancelStream();

  /// Another stream can be opened on it.
  [[nodiscard]] bool usable() const { return link_->up() && !link_->over(); }
  /// Bytes of messages that wait for the server, or for the kernel.
  [[nodiscard]] std::size_t unsent() const;
  /// As for TlsLink; on a link that others use it is the stream that is not read. After Cut and
  /// Freeze, which are the whole link's, no event comes.
  void PauseReading(bool pause);
  void SetDelay(milliseconds delay) { link_->link().SetDelay(delay); }
  void Freeze();
  void Cut();

 private:
  void OnUp() override;
  void OnSent() override;
  void OnDown(const absl::Status& why) override;
  void AfterBytes() override;
  void Soon() override;
  void OnHeader(std::string_view name, std::string_view value) override;
  void OnData(std::string_view bytes) override;
  void OnClosed(std::uint32_t error) override;
  std::size_t TakeBody(std::uint8_t* to, std::size_t max, bool& end) override;

  void DeliverMessages();
  void TellEnd();

  StreamEvents* events_;
  std::string authority_;
  const bool record_per_message_;
  std::shared_ptr<Http2Link> link_;
  std::int32_t stream_ = 0;
  /// It was told that the link is up.
  bool joined_ = false;
  bool streaming_ = false;
  /// The server let go of what waited.
  bool sent_more_ = false;
  bool paused_ = false;
  /// Bytes that came and were not read, while it is paused.
  std::size_t unread_ = 0;
  bool half_closed_ = false;

  std::string out_;
  std::size_t out_taken_ = 0;
  /// Bytes of the message that was begun, if each has a frame of its own.
  std::size_t message_left_ = 0;
  std::string in_;
  std::optional<int> grpc_status_;
  std::string grpc_message_;
  std::string http_status_;
  std::optional<StreamEnd> ended_;
  /// Nobody else owns it: by it a posted job sees that the connection is gone.
  std::shared_ptr<GrpcConnection*> self_ = std::make_shared<GrpcConnection*>(this);
};

}  // namespace uplink::link
