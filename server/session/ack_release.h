#pragma once

#include <cstddef>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/robot/robot_sessions.h"
#include "server/session/context.h"
#include "server/session/intake.h"
#include "server/session/stream_timers.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// When a stream's next Ack is due, and its numbers. It is due after kAckMessages messages, after
/// limits.ack_interval (Timer::kAck), when a settled message comes again, when a commit moves it,
/// at Welcome and at the end. Confined to the stream's thread.
class AckRelease final {
 public:
  AckRelease(const SessionContext& context, StreamTimers& timers)
      : context_(context), timers_(timers) {}

  /// Messages were processed.
  void AddProcessed(const Intake::Processed& processed);
  /// Commits have settled messages of the session.
  void AddProgress(const robot::Progress& progress);
  /// Arrivals of messages that an Ack may cover now, for the ack latency.
  void AddReleased(const std::vector<SteadyTime>& released);
  void MakeDue() { due_ = true; }
  [[nodiscard]] bool due() const { return due_; }

  /// The Ack for this progress. Every Reject that it covers must have been written.
  [[nodiscard]] v1::RelayResponse Release(const robot::Progress& progress);

 private:
  const SessionContext& context_;
  StreamTimers& timers_;
  /// The highest numbers in an Ack of this stream.
  model::Seq acked_through_ = 0;
  model::Seq acked_judged_ = 0;
  bool due_ = false;
  std::size_t unacked_messages_ = 0;
  /// At most kReleasedMax.
  std::vector<SteadyTime> released_;
};

}  // namespace uplink::session
