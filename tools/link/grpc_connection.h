#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tools/link/http2_link.h"
#include "tools/link/stream_connection.h"
#include "tools/link/tls_link.h"

namespace uplink::link {

/// Messages of a server longer than that end the stream.
inline constexpr std::size_t kMessageBytesMax = 4 * 1024 * 1024;

/// A connection of its own, or a part in one that others use too, with one bidirectional gRPC
/// stream at a time, for programs that open thousands. It has no retries, name resolution or load
/// balancing, as gRPC's own library does.
///
/// Thread: confined to the loop's thread.
/// Source: "gRPC over HTTP2", the protocol's own description.
class GrpcConnection final : public StreamConnection, private LinkUser, private Http2Events {
 public:
  GrpcConnection(Loop& loop, LinkOptions options, StreamEvents& events);
  /// A part in this link.
  GrpcConnection(std::shared_ptr<Http2Link> link, std::string authority, StreamEvents& events);
  /// Closes the connection in an orderly way, or of a link that others use its stream.
  ~GrpcConnection() override;
  GrpcConnection(const GrpcConnection&) = delete;
  GrpcConnection& operator=(const GrpcConnection&) = delete;

  void Connect() override { link_->Connect(); }
  void SetEvents(StreamEvents& events) override { events_ = &events; }
  bool OpenStream(const std::string& path) override;
  void Send(std::string_view message) override;
  void HalfClose() override;
  void CancelStream() override;

  [[nodiscard]] bool usable() const override { return link_->up() && !link_->over(); }
  [[nodiscard]] std::size_t unsent() const override;
  /// On a link that others use it is the stream that is not read.
  void PauseReading(bool pause) override;
  void SetDelay(milliseconds delay) override { link_->link().SetDelay(delay); }
  /// Of the whole link.
  void Freeze() override;
  void Cut() override;

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
  /// Its only owner is this object: a posted job sees by a weak_ptr that the connection is gone.
  std::shared_ptr<GrpcConnection*> self_ = std::make_shared<GrpcConnection*>(this);
};

}  // namespace uplink::link
