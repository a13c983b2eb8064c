#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <absl/status/status.h>

#include "server/identity/peer_identity.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/frame_sink.h"
#include "server/session/frame_view.h"
#include "server/session/hello_wait.h"
#include "server/session/intake.h"
#include "server/session/outgoing.h"
#include "server/session/read_gate.h"
#include "server/session/reject_pages.h"
#include "server/session/resend_requests.h"
#include "server/session/settling.h"
#include "server/session/slow_frame.h"
#include "server/session/stream_timers.h"

namespace uplink::session {

/// One stream's side of the relay protocol: frames in, frames out, timers; no transport in it.
///
/// Life: Start; then the transport calls On...; after FrameSink::Finish it calls nothing but
/// OnBroken. May be destroyed once `done()`.
/// Thread: confined to the stream's thread. Other threads reach it by loop::StreamRef::Wake alone,
/// which makes the transport call OnWake there.
class Session final {
 public:
  Session(const SessionContext& context, identity::PeerIdentity peer, loop::StreamRef self,
          FrameSource& source, FrameSink& sink);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Asks for the first frame.
  void Start();
  /// One frame, whole: a serialized RelayRequest.
  void OnFrame(std::string_view bytes);
  /// Bytes of a frame came that is not whole yet.
  void OnFrameBytes() {
    if (state_ != State::kStreaming || !slow_frame_.Add(context_.clock.Steady())) return;
    robot_.robot().state.SignOfLife(context_.clock.Steady(), context_.clock.System(),
                                    presence_limits());
  }
  /// The peer answered FrameSink::AskPeer.
  void OnPeerAnswered() {
    if (done() || !robot_.attached()) return;
    robot_.robot().state.NotePeerAnswered(context_.clock.Steady(), presence_limits());
  }
  /// The peer's frame was over limits.frame_bytes_max or frame_bytes_max(); `bytes` is its size.
  void OnFrameTooLarge(std::uint64_t bytes);
  /// The agent half-closed.
  void OnHalfClose();
  /// The stream is gone: nothing can be written any more. `code` is what its peer's reset meant, or
  /// with what the transport ended it, if it was not cut. Idempotent.
  void OnBroken(std::optional<absl::StatusCode> code = std::nullopt) {
    if (done()) return;
    context_.probe.CountEnd(code);
    Leave();
  }
  /// The write under way is done.
  void OnWritten();
  void OnWake();
  /// `deadline()` has come.
  void OnTimer();
  /// The server drains: tell the agent, read no more, settle, end within `grace`.
  void OnDrain(milliseconds grace);

  /// Bytes of the largest frame that it takes next: until the Hello came, what one may have. Past
  /// it a transport that knows the size before the bytes calls OnFrameTooLarge.
  [[nodiscard]] std::size_t frame_bytes_max() const {
    const std::size_t limit = context_.limits.frame_bytes_max;
    return state_ == State::kHello ? std::min(limit, kHelloFrameBytesMax) : limit;
  }
  /// When OnTimer wants to be called; the transport asks after each call. Calling it early is
  /// right.
  [[nodiscard]] std::optional<SteadyTime> deadline() const;
  /// The robot that a Hello in order named; empty before that.
  [[nodiscard]] const std::string& ruri() const { return robot_.ruri(); }
  /// It ends since its agent confirmed too few Rejects (limits.unconfirmed_rejects_max).
  [[nodiscard]] bool unconfirmed() const { return settling_.unconfirmed(); }
  /// Finish was called, or the stream broke.
  [[nodiscard]] bool done() const { return state_ == State::kDone; }

 private:
  enum class State : std::uint8_t {
    /// Waits for Hello.
    kHello,
    /// Waits since streams of the robot come too often; the robot's stream goes on meanwhile.
    kDelayed,
    /// Waits until the older stream of the robot has stopped.
    kAttaching,
    /// Waits for the store's cursor, kWelcomeWait at most.
    kOpening,
    kStreaming,
    /// The agent half-closed, or the server drains: settle what was processed, then end.
    kSettling,
    kDone,
  };
  /// What a call brings besides its own work, for Advance.
  enum class News : std::uint8_t {
    kNone,
    /// Commits may have settled messages.
    kCommits,
    /// The stream is read no more.
    kLastFrame,
  };

  void HandleHello(std::string_view bytes);
  void Attach();
  /// Ends the stream if it is not the robot's any more, and begins its opening if it has become so.
  /// False unless it is the robot's and goes on.
  bool FollowStanding(robot::Standing standing);
  void BeginOpening();
  void SendWelcome();
  void HandleBatch();

  /// What every call ends with, in this order: process what is pending, collect what commits
  /// brought, write, end the stream once all is settled, and ask for the next frame.
  void Advance(News news);
  void ProcessAndWrite(News news);
  /// Ends the stream if too many Rejects wait to be confirmed: what was processed is settled first.
  /// True if it does.
  bool EndForRejects();
  void EndWhenSettled();
  void Read();

  /// The limits by which the robot is judged.
  [[nodiscard]] const robot::PresenceLimits& presence_limits() {
    return context_.fleet.presence_limits_of(robot_.robot());
  }
  void ProtocolError(std::string_view rule);
  void Finish(const absl::Status& status);
  void Leave();

  const SessionContext context_;
  /// Until its Hello: a gateway's may name hundreds of robots, and each of its streams has a copy.
  identity::PeerIdentity peer_;
  FrameSink& sink_;

  State state_ = State::kHello;
  std::uint64_t frames_ = 0;
  model::Seq last_seq_ = 0;

  StreamTimers timers_;
  Attachment robot_;
  HelloWait hello_wait_;
  ReadGate reading_;
  SlowFrame slow_frame_;
  /// From kOpening on.
  std::unique_ptr<Intake> intake_;
  Outgoing outgoing_;
  RejectPages reject_pages_;
  ResendRequests resends_;
  Settling settling_;
};

}  // namespace uplink::session
