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
#include "server/session/stream_report.h"
#include "server/session/stream_timers.h"
#include "server/transport/end_cause.h"
#include "server/transport/peer_connection.h"

namespace uplink::session {

/// Who opened a stream. A value.
struct Peer {
  identity::PeerIdentity identity;
  /// Outlives the session. Null: where the stream comes from is unknown.
  const transport::PeerConnection* connection = nullptr;
};

/// One stream's side of the relay protocol: frames in, frames out, timers; no transport in it.
///
/// Life: Start; then the transport calls On...; after FrameSink::Finish it calls only OnBroken. May
/// be destroyed once `done()`.
/// Thread: confined to the stream's thread. Other threads only call loop::StreamRef::Wake, which
///         makes the transport call OnWake there.
class Session final {
 public:
  Session(const SessionContext& context, Peer peer, loop::StreamRef self, FrameSource& source,
          FrameSink& sink);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Asks for the first frame.
  void Start() {
    timers_.Set(Timer::kHello, hello_wait_.Begin(context_.clock.Steady()));
    reading_.Request();
  }
  /// One complete frame: a serialized RelayRequest.
  void OnFrame(std::string_view bytes);
  /// Bytes of an incomplete frame came.
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
  /// The stream is gone: nothing can be written. Idempotent.
  void OnBroken(const transport::Ending& ending = {}) {
    if (done()) return;
    context_.probe.CountEnd(ending.code);
    // An agent that was told to leave leaves as it likes. Its half-close alone is no end yet.
    const bool told =
        state_ == State::kSettling && settling_.cause() != transport::EndCause::kClosed;
    Leave(told ? transport::Ending{.cause = settling_.cause(), .code = ending.code} : ending);
  }
  /// The write under way is done.
  void OnWritten();
  void OnWake();
  /// `deadline()` has come.
  void OnTimer();
  /// The server drains, or the connection: tells the agent, stops reading, settles, and ends within
  /// `grace`.
  void OnDrain(milliseconds grace, transport::EndCause cause = transport::EndCause::kDrain);

  /// Bytes that the next frame may have; before the Hello, those of a Hello. A transport that
  /// learns from a frame's head that it is larger calls OnFrameTooLarge.
  [[nodiscard]] std::size_t frame_bytes_max() const {
    const std::size_t limit = context_.limits.frame_bytes_max;
    return state_ == State::kHello ? std::min(limit, kHelloFrameBytesMax) : limit;
  }
  /// When OnTimer is due; the transport asks after each call, and may call OnTimer early.
  [[nodiscard]] std::optional<SteadyTime> deadline() const {
    return done() ? std::nullopt : timers_.Next();
  }
  /// The robot that a valid Hello named; empty before.
  [[nodiscard]] const std::string& ruri() const { return robot_.ruri(); }
  /// It ends because its agent confirmed too few Rejects (limits.unconfirmed_rejects_max).
  [[nodiscard]] bool unconfirmed() const { return settling_.unconfirmed(); }
  /// Finish was called, or the stream broke.
  [[nodiscard]] bool done() const { return state_ == State::kDone; }

 private:
  enum class State : std::uint8_t {
    /// Waits for Hello.
    kHello,
    /// Waits because streams of the robot come too often; the robot's stream goes on meanwhile.
    kDelayed,
    /// Waits until the older stream of the robot has stopped.
    kAttaching,
    /// Waits for the store's cursor, kWelcomeWait at most.
    kOpening,
    kStreaming,
    /// The agent half-closed, the server drains, or too many Rejects are unconfirmed: settle what
    /// was processed, then end.
    kSettling,
    kDone,
  };
  /// What an event means for Advance.
  enum class News : std::uint8_t {
    kNone,
    /// Commits may have settled messages.
    kCommits,
    /// The stream is not read any more.
    kLastFrame,
  };

  void HandleHello(std::string_view bytes);
  void Attach();
  /// Ends the stream if it is no longer the robot's; begins its opening if it has become the
  /// robot's. True only if it is the robot's and goes on.
  bool FollowStanding(robot::Standing standing);
  void BeginOpening();
  void SendWelcome();
  void HandleBatch();

  /// Every call ends with this: process pending messages, collect what commits settled, write, end
  /// the stream once all is settled, and request the next frame.
  void Advance(News news);
  void ProcessAndWrite(News news);
  /// Begins to end the stream if too many Rejects are unconfirmed; processed messages are settled
  /// first. True if it does.
  bool EndForRejects();
  void EndWhenSettled();
  void Read();

  /// The limits by which the robot is judged.
  [[nodiscard]] const robot::PresenceLimits& presence_limits() {
    return context_.fleet.presence_limits_of(robot_.robot());
  }
  void ProtocolError(std::string_view rule);
  void Finish(const absl::Status& status, transport::EndCause cause);
  void Leave(const transport::Ending& ending);

  const SessionContext context_;
  /// Kept until its Hello: a gateway's names hundreds of robots, and each of its streams has a
  /// copy.
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
  StreamReport report_;
};

}  // namespace uplink::session
