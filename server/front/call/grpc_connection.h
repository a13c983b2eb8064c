#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

#include "server/front/call/call.h"
#include "server/front/call/call_set.h"
#include "server/front/call/thread.h"
#include "server/front/door/origin.h"
#include "server/front/http2/frame_rates.h"
#include "server/front/http2/http2.h"
#include "server/front/http2/ping_strikes.h"
#include "server/front/tls/tls_peer.h"
#include "server/transport/drain.h"
#include "server/transport/peer_connection.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// Sends what a gRPC connection writes.
class GrpcConnectionOwner {
 public:
  virtual ~GrpcConnectionOwner() = default;
  /// CallOwner::Settle.
  virtual void Settle() = 0;
  /// The first call began, or the last one ended: `calls` are open now.
  virtual void OnCalls(std::size_t calls) = 0;
  /// A peer without a certificate has shown the token of this name; the first time.
  virtual void OnCaller(std::string_view name) = 0;
};

/// One connection above TLS: HTTP/2 and its calls, what its peer may cost, and when it stops
/// serving calls.
///
/// Thread: confined to its thread's.
class GrpcConnection final : public Http2Peer, public CallOwner {
 public:
  struct Setup {
    TlsPeer peer;
    /// Outlives it.
    const Origin& origin;
    /// Streams that the peer may open at once.
    std::uint32_t streams_max = 0;
    /// Unary calls that it may make per second, beyond those that its streams need.
    std::uint32_t calls_per_second = 0;
  };

  GrpcConnection(Thread& thread, GrpcConnectionOwner& owner, Setup setup);
  GrpcConnection(const GrpcConnection&) = delete;
  GrpcConnection& operator=(const GrpcConnection&) = delete;

  /// False if the peer broke the rules: it is turned away.
  [[nodiscard]] bool Receive(std::string_view plain);
  /// Turns away a peer that reads no answers (Http2::flooded).
  void EndFlood();
  /// Settles touched calls.
  void SettleCalls();
  /// All calls are settled.
  [[nodiscard]] bool settled() const { return calls_.settled(); }
  /// Ends the session if no more calls are served and the last one has ended; true if it did now.
  [[nodiscard]] bool EndIfLast();
  /// Ends the connection for its peer's behaviour, with the reason in a GOAWAY.
  void TurnAway(transport::TurnedAway cause, std::string_view text);
  /// Its peer may not come in any more: ends its calls, and each that it still opens, with `why`.
  void Ban(const absl::Status& why, transport::EndCause cause);
  [[nodiscard]] bool banned() const { return ban_.has_value(); }
  /// Serves no more calls.
  void StopServing() { ending_ = true; }
  /// Tells the peer, and each call (CallSet::Drain).
  void Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end,
             transport::EndCause cause = transport::EndCause::kDrain);
  /// Ends all streams without blame.
  void End();
  /// The connection below is gone.
  void Break() {
    calls_.Break();
    connection_.End();
  }

  [[nodiscard]] Http2& http2() { return http2_; }
  [[nodiscard]] std::size_t calls() const { return calls_.size(); }
  [[nodiscard]] bool turned_away() const { return turned_away_; }
  /// No call is served here any more.
  [[nodiscard]] bool ends() const { return turned_away_ || ending_; }
  /// A handler served a call of it.
  [[nodiscard]] bool served() const { return served_; }
  /// A call was answered: served, or refused and counted as that.
  [[nodiscard]] bool answered() const { return answered_; }

  // Http2Peer
  Http2Stream* OnStream(std::int32_t id) override;
  void OnFrame(FrameKind kind) override;
  void OnHeaderBomb() override { TurnAway(transport::TurnedAway::kHeaders, "headers"); }
  void OnPong() override { calls_.TellPeerAnswered(); }
  void OnSent() override;
  void OnStreamFault(std::string_view code) override;
  void OnFault() override { TurnAway(transport::TurnedAway::kProtocol, ""); }
  // CallOwner
  void Touch(Call& call) override { calls_.Touch(call); }
  void Settle() override { owner_.Settle(); }
  [[nodiscard]] const TlsPeer& tls_peer() const override { return peer_; }
  [[nodiscard]] const Origin& origin() const override { return origin_; }
  [[nodiscard]] transport::PeerConnection& connection() override { return connection_; }
  void AskPeer() override { http2_.PingOnce(); }
  void NoteCaller(std::string_view name) override {
    if (peer_.anonymous && !std::exchange(proven_, true)) owner_.OnCaller(name);
  }
  [[nodiscard]] std::optional<absl::Status> refusal() const override;

 private:
  Thread& thread_;
  GrpcConnectionOwner& owner_;
  const TlsPeer peer_;
  const Origin& origin_;
  transport::PeerConnection connection_;
  Http2 http2_;
  CallSet calls_;
  FrameRates frames_;
  PingStrikes pings_;
  /// The connection ends with its last call.
  bool ending_ = false;
  bool last_streams_told_ = false;
  bool served_ = false;
  bool answered_ = false;
  /// It has shown a token.
  bool proven_ = false;
  bool turned_away_ = false;
  /// Why no call is served any more, if its peer is banned.
  std::optional<absl::Status> ban_;
};

}  // namespace uplink::front
