#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tools/link/dial.h"
#include "tools/link/loop.h"
#include "tools/link/stream_connection.h"

namespace uplink::link {

/// A connection by the gRPC library, with the client that protoc makes of relay.proto: what the
/// world's agents are built on. It costs more than GrpcConnection, and knows no bad network:
/// SetDelay does nothing, Freeze stops reads and writes alone (the library still answers pings),
/// and Cut cancels the stream.
///
/// OnConnected comes at once: the library connects when a stream is opened, and its failure ends
/// that stream.
/// Thread: confined to the loop's thread; the destructor waits until the library has let go of the
/// stream, a moment.
class LibraryConnection final : public StreamConnection {
 public:
  LibraryConnection(Loop& loop, const DialOptions& options, StreamEvents& events);
  ~LibraryConnection() override;
  LibraryConnection(const LibraryConnection&) = delete;
  LibraryConnection& operator=(const LibraryConnection&) = delete;

  void Connect() override;
  void SetEvents(StreamEvents& events) override { events_ = &events; }
  /// The one method of the stub: `/uplink.v1.UplinkRelay/Relay`; false for another.
  bool OpenStream(const std::string& path) override;
  /// A message that is no RelayRequest is our own bug.
  void Send(std::string_view message) override;
  void HalfClose() override;
  void CancelStream() override;

  [[nodiscard]] bool usable() const override { return usable_ && call_ == nullptr; }
  [[nodiscard]] std::size_t unsent() const override;
  void PauseReading(bool pause) override;
  void SetDelay(milliseconds /*delay*/) override {}
  void Freeze() override;
  void Cut() override;

 private:
  class Call;
  struct Channel;

  void OnMessage(std::string_view message);
  void OnWritten();
  void OnEnded(const StreamEnd& end);

  Loop& loop_;
  StreamEvents* events_;
  std::unique_ptr<Channel> channel_;
  std::unique_ptr<Call> call_;
  /// False once a stream ended because the server was not there.
  bool usable_ = true;
  bool paused_ = false;
  bool silent_ = false;
  /// Null within it once the connection is gone: by it a posted job sees that.
  std::shared_ptr<LibraryConnection*> self_ = std::make_shared<LibraryConnection*>(this);
};

}  // namespace uplink::link
