#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/sync_stream.h>

#include "schema/model/ids.h"
#include "tests/support/certificates.h"
#include "tests/support/eventually.h"
#include "tests/support/relay_samples.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::testing {

/// What a channel to a relay on loopback is made of.
struct ChannelSpec {
  std::uint16_t port = 0;
  /// The authority that the server's certificate must come from; empty: plaintext.
  std::string server_ca;
  /// What the agent shows; empty: no client certificate.
  KeyPair identity;
  /// Bytes that the server may send ahead of the agent's reads; 0: gRPC's default.
  int lookahead_bytes = 0;
};

/// A channel with a connection of its own.
[[nodiscard]] std::shared_ptr<grpc::Channel> MakeChannel(const ChannelSpec& spec);

/// One Relay call of an agent, blocking: every wait ends with the call's deadline. Frames go out as
/// the bytes that the test gives, right or wrong. Confined to one thread.
class TestAgent final {
 public:
  struct Options {
    std::chrono::milliseconds patience = kPatience;
    /// Asks gRPC to compress what is sent.
    bool compress = false;
    /// The full name of the method.
    const char* method = "/uplink.v1.UplinkRelay/Relay";
  };

  /// Starts the call.
  explicit TestAgent(const std::shared_ptr<grpc::Channel>& channel);
  TestAgent(const std::shared_ptr<grpc::Channel>& channel, const Options& options);
  /// Cancels a call that has not ended.
  ~TestAgent();
  TestAgent(const TestAgent&) = delete;
  TestAgent& operator=(const TestAgent&) = delete;

  /// False once the call is over.
  bool Send(const v1::RelayRequest& frame);
  bool SendBytes(std::string_view bytes);
  void HalfClose();
  /// Breaks the stream.
  void Cancel();

  /// The next frame; nothing once the call is over.
  std::optional<v1::RelayResponse> Read();
  /// Hello, then the Welcome that must be the first answer; nothing if it was not.
  std::optional<v1::Welcome> Connect(const model::SessionId& session, model::Seq settled = 0,
                                     model::Seq judged = 0);
  /// Reads until an Ack whose through_seq is at least `through`; nothing if the call ends before.
  std::optional<v1::Ack> ReadThrough(model::Seq through);
  /// Reads until an Ack whose judged_seq is at least `judged`.
  std::optional<v1::Ack> ReadJudged(model::Seq judged);
  /// Reads what is left and returns with what the call ended.
  grpc::Status End();

  /// All that was read, in order.
  [[nodiscard]] const std::vector<v1::RelayResponse>& frames() const { return frames_; }
  /// The Rejects among them.
  [[nodiscard]] std::vector<v1::Reject> rejects() const;

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream_;
  std::vector<v1::RelayResponse> frames_;
  std::optional<grpc::Status> ended_;
};

}  // namespace uplink::testing
