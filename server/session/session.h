#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>

#include "server/identity/peer_identity.h"
#include "server/session/frame_sink.h"
#include "server/session/hello.h"
#include "server/session/intake.h"

namespace uplink::session {

/// One stream's side of the relay protocol: frames in, frames out, timers; no transport in it.
///
/// Life: Start; then the transport calls On...; after FrameSink::Finish it calls nothing but
/// OnBroken. May be destroyed once `done()`.
/// Thread: confined to the stream's thread. Other threads reach it by StreamRef::Wake alone, which
/// makes the transport call OnWake there.
class Session final {
 public:
  Session(const SessionContext& context, identity::PeerIdentity peer, robot::StreamRef self,
          FrameSource& source, FrameSink& sink);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Asks for the first frame.
  void Start();
  /// One frame, whole: a serialized RelayRequest.
  void OnFrame(std::string_view bytes);
  /// The peer's frame was over limits.frame_bytes_max; `bytes` is its size.
  void OnFrameTooLarge(std::uint64_t bytes);
  /// The agent half-closed.
  void OnHalfClose();
  /// The stream is gone: nothing can be written any more. Idempotent.
  void OnBroken();
  /// The write under way is done.
  void OnWritten();
  void OnWake();
  /// `deadline()` has come.
  void OnTimer();
  /// The server drains: tell the agent, read no more, settle, end within `grace`.
  void OnDrain(milliseconds grace);

  /// When OnTimer wants to be called; the transport asks after each call. Calling it early is
  /// right.
  [[nodiscard]] std::optional<SteadyTime> deadline() const;
  /// Finish was called, or the stream broke.
  [[nodiscard]] bool done() const { return state_ == State::kDone; }

 private:
  enum class State : std::uint8_t {
    /// Waits for Hello.
    kHello,
    /// Waits until the older stream of the robot has stopped.
    kAttaching,
    /// Waits for the store's cursor, kWelcomeWait at most.
    kOpening,
    kStreaming,
    /// The agent half-closed, or the server drains: settle what was taken, then end.
    kSettling,
    kDone,
  };

  void TakeHello(const v1::Hello& hello);
  void BeginOpening();
  void SendWelcome();
  void TakeHelloFrame(std::string_view bytes);
  void TakeBatch();
  void TakePending();
  void TakeProgress();
  void NoteReleased(const std::vector<SteadyTime>& released);
  void Read();
  void RequestRead();
  void NoteStall();
  void SetHeldBack(bool held_back);
  void Flush();
  bool WriteNext();
  [[nodiscard]] std::optional<v1::RelayResponse> NextAck();
  void EndWhenSettled();
  void Finish(const absl::Status& status);
  void Leave();
  void ProtocolError(std::string_view rule);

  const SessionContext context_;
  const identity::PeerIdentity peer_;
  const robot::StreamRef self_;
  FrameSource& source_;
  FrameSink& sink_;

  State state_ = State::kHello;
  std::uint64_t frames_ = 0;
  bool read_under_way_ = false;
  bool write_under_way_ = false;
  bool held_back_ = false;

  HelloTerms hello_;
  robot::Robot* robot_ = nullptr;
  std::uint64_t open_id_ = 0;
  std::unique_ptr<Intake> intake_;
  model::Seq last_seq_ = 0;

  std::deque<v1::RelayResponse> outgoing_;
  /// The highest numbers that an Ack of this stream has said.
  model::Seq acked_through_ = 0;
  model::Seq acked_judged_ = 0;
  bool ack_due_ = false;
  std::size_t unacked_messages_ = 0;
  std::vector<SteadyTime> released_;
  /// With what kSettling ends; set once nothing waits and the last Ack is due.
  absl::Status end_status_;
  bool last_ack_queued_ = false;

  std::optional<SteadyTime> hello_until_;
  std::optional<SteadyTime> read_again_at_;
  std::optional<SteadyTime> ack_at_;
  std::optional<SteadyTime> welcome_at_;
  std::optional<SteadyTime> stalled_at_;
  std::optional<SteadyTime> settle_until_;
};

}  // namespace uplink::session
