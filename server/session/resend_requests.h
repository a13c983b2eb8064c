#pragma once

#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/outgoing.h"
#include "server/session/stream_timers.h"
#include "storage/latest_kind.h"

namespace uplink::session {

/// Asks the robot of one stream for messages that the store lacks (robot::Resends): kResendGrace
/// after Welcome or when the store has answered, whichever is later, and again each
/// robot::kResendEvery while one is missing. Confined to the stream's thread.
class ResendRequests final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    Outgoing& outgoing;
    StreamTimers& timers;
  };
  explicit ResendRequests(const Sources& sources) : sources_(sources) {}

  /// Welcome goes out.
  void Begin();
  /// Asks if it is due.
  void Follow();
  /// The stream ends, or has ended.
  void End() { CountUnanswered(0); }

 private:
  void CountUnanswered(storage::LatestKindSet unanswered);

  const Sources sources_;
  SteadyTime first_at_;
  /// What this stream counts in the probe.
  storage::LatestKindSet unanswered_ = 0;
};

}  // namespace uplink::session
