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

/// Whether a stream's next frame is asked for, and if not, what will call it again; tells the
/// robot's presence that its silence is ours while it is held back. Confined to the stream's
/// thread.
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

  /// The peer's time to read runs (Timer::kStall) while `outgoing` frames are too many.
  void WatchPeer(std::size_t outgoing);
  /// Whether the robot's stream is not read now; counted once per change. Where the server itself
  /// wants no more of it, nothing holds it back.
  using Reading = robot::RobotState::Reading;
  void SetReading(Reading reading);

 private:
  void Tell(robot::HeldBack by);

  const Sources sources_;
  bool under_way_ = false;
  Reading reading_ = Reading::kFlowing;
  /// What the robot's views were told last.
  robot::HeldBack told_ = robot::HeldBack::kNone;
};

}  // namespace uplink::session
