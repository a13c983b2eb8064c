#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "server/front/call/grpc_connection.h"
#include "server/front/door/door_book.h"
#include "server/front/door/place.h"
#include "server/front/lifetime.h"
#include "server/front/loop/socket.h"
#include "server/front/tls/tls_engine.h"
#include "server/transport/drain.h"
#include "server/transport/timers.h"

namespace uplink::front {

class Connection;

/// What a connection reports to its thread.
class ConnectionOwner {
 public:
  virtual ~ConnectionOwner() = default;
  /// The TLS handshake has ended, with or without success.
  virtual void OnHandshakeEnded(Connection& connection) = 0;
  /// Another connection of the same certificate must be closed.
  virtual void EvictOther(std::uint64_t connection) = 0;
  /// It is closed, and may be destroyed after this call.
  virtual void OnClosed(Connection& connection) = 0;
};

/// One TCP connection: its socket, TLS, gRPC over them, and when it ends.
///
/// Every event ends in Settle, which settles calls, sends what they wrote, and closes the
/// connection once nothing is left to send.
/// Thread: confined to its thread's.
class Connection final : public SocketOwner, public GrpcConnectionOwner {
 public:
  struct Setup {
    std::uint64_t id = 0;
    int descriptor = -1;
    Origin origin;
    std::shared_ptr<const TlsContext> tls;
    /// Where later ones stand; null: there are none.
    const ServedContext* served = nullptr;
    /// limits.connection_age_max; zero: never.
    milliseconds age_max{0};
    /// limits.gateway_streams_max.
    std::uint32_t gateway_streams_max = 0;
  };

  Connection(Thread& thread, EventLoop& loop, ConnectionOwner& owner, Setup setup);
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Start();
  void OnTimer();
  /// The handshake gives way to others. No effect once it has ended.
  void CutHandshake() {
    if (phase_ != Phase::kHandshake) return;
    FailHandshake(transport::TurnedAway::kGaveWay);
    Close();
  }
  /// Its certificate has too many connections.
  void Evict();
  /// Ends its calls if its certificate is on the list now.
  void LookAtDenied();
  /// Ends its calls if its authority does not vouch for it any more.
  void LookAtAuthorities(const TlsContext& now);
  /// The server drains: tells its calls one after the other, the first as number `first` of
  /// `spread`. They have until `end`.
  void Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end,
             transport::EndCause cause = transport::EndCause::kDrain);
  /// Ends everything at once, and sends what can still be sent.
  void Shutdown();
  /// Does what other events left to do.
  void Settle() override;

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] std::size_t calls() const { return grpc_ != nullptr ? grpc_->calls() : 0; }

  // SocketOwner
  void OnReceived(std::string_view bytes) override;
  void OnReceiveEnd() override;
  void OnUnblocked() override {
    thread_.clock.Advance();
    lifetime_.SetBlocked(false, {}, thread_.clock.Steady());
    if (phase_ == Phase::kLinger) socket_.EndOutput();
  }
  void AfterEvent() override { Settle(); }
  [[nodiscard]] Turn turn() const override;
  // GrpcConnectionOwner
  void OnCalls(std::size_t calls) override {
    if (grpc_->served()) lifetime_.NoteServed();
    lifetime_.SetCalls(calls, thread_.clock.Steady());
    place_.SetStreams(calls);
  }
  void OnCaller(std::string_view name) override {
    const auto evicted = place_.CountAs(KeyOfCaller(name), origin_, thread_.clock.Steady());
    if (evicted) owner_.EvictOther(*evicted);
  }

 private:
  enum class Phase : std::uint8_t {
    kHandshake,
    kOpen,
    /// We have sent everything, and read on for a moment.
    kLinger,
    kClosed,
  };

  void Handshake();
  void BeginGrpc();
  void ReadPlain();
  /// Sends what the peer takes; true if anything went out.
  bool Flush();
  void EndIfDone();
  /// Sends nothing more, and lets the peer read what was sent.
  void Linger();
  void Close();
  /// Closes it, and notes why for its calls.
  void CloseFor(transport::EndCause cause) {
    if (grpc_ != nullptr) grpc_->connection().NoteEnd(cause);
    Close();
  }
  /// Why the peer's side ended: between two calls a peer leaves in order by just that.
  [[nodiscard]] transport::EndCause CauseOfReceiveEnd() const {
    if (socket_.timed_out()) return transport::EndCause::kUnanswered;
    return calls() == 0 && !socket_.failed() ? transport::EndCause::kClosed
                                             : transport::EndCause::kCut;
  }
  /// Why the peer does not take what waits for it: it may be gone.
  [[nodiscard]] transport::EndCause CauseOfBlocked() const {
    return socket_.unanswered() ? transport::EndCause::kUnanswered : transport::EndCause::kNotRead;
  }
  void SetTimer();
  void LookAtHandshake(SteadyTime now);
  void LookAtLifetime(SteadyTime now);
  [[nodiscard]] milliseconds UntilExpiry() const {
    return grpc_->tls_peer().UntilExpiry(thread_.clock.System(),
                                         thread_.relay.clock_trust.vouched());
  }
  void FailHandshake(transport::TurnedAway cause);
  /// The peer of the handshake, by authorities and deny list as they are now.
  [[nodiscard]] TlsPeer JudgedPeer();
  [[nodiscard]] bool MayBeBanned() const;
  [[nodiscard]] bool IsDenied(const TlsPeer& peer) const;
  void CountDenied(transport::Denied why);

  Thread& thread_;
  ConnectionOwner& owner_;
  const std::uint64_t id_;
  Origin origin_;
  const milliseconds age_max_;
  const std::uint32_t gateway_streams_max_;
  const ServedContext* const served_;

  Phase phase_ = Phase::kHandshake;
  Socket socket_;
  std::unique_ptr<TlsEngine> tls_;
  Place place_;
  Lifetime lifetime_;
  /// Once the handshake is done.
  std::unique_ptr<GrpcConnection> grpc_;

  /// Until when the handshake or the lingering may last.
  std::optional<SteadyTime> phase_by_;
  std::size_t linger_reads_ = 0;
  SteadyTime handshake_by_;
  transport::Timers::Slot timer_;
};

}  // namespace uplink::front
