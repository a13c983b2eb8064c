#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "server/front/call/call.h"
#include "server/session/frame_sink.h"
#include "server/session/session.h"
#include "server/transport/call_handler.h"
#include "server/transport/gate.h"

namespace uplink::front {

/// UplinkRelay's Relay: one call between the wire and a Session.
///
/// Thread: confined to its connection's.
class RelayHandler final : public transport::CallHandler,
                           public session::FrameSource,
                           public session::FrameSink {
 public:
  /// Its row of the table.
  [[nodiscard]] static transport::Methods Served();
  RelayHandler(const RelayHandler&) = delete;
  RelayHandler& operator=(const RelayHandler&) = delete;

  // transport::CallHandler
  void Start() override { session_->Start(); }
  [[nodiscard]] std::uint64_t message_bytes_max() const override {
    return session_->frame_bytes_max();
  }
  void OnMessage(std::string_view bytes) override { session_->OnFrame(bytes); }
  void OnTooLarge(std::uint64_t bytes) override { session_->OnFrameTooLarge(bytes); }
  void OnHalfClose() override { session_->OnHalfClose(); }
  void OnMessageBytes() override { session_->OnFrameBytes(); }
  void OnPeerAnswered() override { session_->OnPeerAnswered(); }
  void OnBroken(const transport::Ending& ending) override;
  void OnWritten() override { session_->OnWritten(); }
  void OnWake() override { session_->OnWake(); }
  void OnTimer() override { session_->OnTimer(); }
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return session_->deadline(); }
  void OnDrain(milliseconds grace) override {
    session_->OnDrain(grace, call_.connection()->drain());
  }

  // session::FrameSource
  void RequestRead() override { call_.RequestMessage(); }
  // session::FrameSink
  void Write(const v1::RelayResponse& frame) override;
  void WriteEncoded(std::span<const session::EncodedFrame> frames) override;
  void Finish(const absl::Status& status) override;
  void Cancel() override { call_.Cancel(); }
  void AskPeer() override { call_.AskPeer(); }

 private:
  explicit RelayHandler(Call& call) : call_(call) {}
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<transport::CallHandler>> Serve(Call& call);

  Call& call_;
  /// Last, so that it goes before what it writes to.
  std::optional<session::Session> session_;
};

}  // namespace uplink::front
