#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "server/ingest/room.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/frame_sink.h"
#include "server/session/stream_timers.h"

namespace uplink::session {

/// Requests a stream's next frame, or waits for what will allow it. While the stream is held back,
/// it tells the robot's presence that the silence is the server's. Confined to the stream's thread.
class ReadGate final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    FrameSource& source;
    StreamTimers& timers;
  };
  explicit ReadGate(const Sources& sources) : sources_(sources) {}

  /// Asks for the next frame.
  void Request();
  /// The transport has answered the request.
  void OnAnswer() { under_way_ = false; }
  [[nodiscard]] bool under_way() const { return under_way_; }
  /// Asks for the next frame if `block` is none. Otherwise waits until the block ends, and the
  /// robot's views show it meanwhile.
  void RequestUnless(const ingest::Block& block);

  /// Runs the peer's time to read (Timer::kStall) while `outgoing` frames are too many.
  void WatchPeer(std::size_t outgoing);
  /// Notes whether the robot's stream is read; counted once per change. A stream that the server
  /// stops reading for good also counts as held back.
  using Reading = robot::RobotState::Reading;
  void SetReading(Reading reading);

  /// How long messages of the stream had to wait in all, without the wait that is under way, and
  /// for what last.
  [[nodiscard]] milliseconds held_back() const {
    return std::chrono::duration_cast<milliseconds>(held_back_total_);
  }
  [[nodiscard]] robot::HeldBack held_back_last() const { return held_back_last_; }

 private:
  void Tell(robot::HeldBack by);

  const Sources sources_;
  bool under_way_ = false;
  Reading reading_ = Reading::kFlowing;
  /// What the robot's views were told last.
  robot::HeldBack told_ = robot::HeldBack::kNone;
  SteadyTime held_back_since_;
  SteadyTime::duration held_back_total_{};
  robot::HeldBack held_back_last_ = robot::HeldBack::kNone;
};

}  // namespace uplink::session
