#pragma once

#include <optional>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/outgoing.h"
#include "server/session/read_gate.h"
#include "server/session/stream_timers.h"
#include "server/transport/end_cause.h"

namespace uplink::session {

/// Ends a stream that is no longer read: once everything processed is settled, with a last Ack, or
/// when its time is over (Timer::kSettle). Confined to the stream's thread.
class Settling final {
 public:
  /// All of them outlive it.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    Outgoing& outgoing;
    ReadGate& reading;
    StreamTimers& timers;
  };
  explicit Settling(const Sources& sources) : sources_(sources) {}

  // The reasons to begin, each at most once. The caller has dropped what was not judged yet.
  /// The agent half-closed.
  void BeginHalfClosed();
  /// The server drains, or the connection does; EndWithin follows.
  void BeginDrained(transport::EndCause cause);
  /// The session has limits.unconfirmed_rejects_max unconfirmed Rejects.
  void BeginUnconfirmed();

  /// BeginUnconfirmed was called, even if a drain has set another status since.
  [[nodiscard]] bool unconfirmed() const { return unconfirmed_; }

  /// Why the stream ends; kClosed before it began to.
  [[nodiscard]] transport::EndCause cause() const { return cause_; }

  /// The server drains: the stream ends within `grace`, whatever it settles for.
  void EndWithin(milliseconds grace);
  /// A write is done. An agent that takes its Rejects gets the time that it needs.
  void OnWritten();
  /// The status with which the stream ends now; empty while something waits. Sends the last Ack.
  [[nodiscard]] std::optional<absl::Status> StatusWhenSettled();

 private:
  void Begin(absl::Status status, ReadGate::Reading reading);
  void SetTime();

  const Sources sources_;
  absl::Status status_;
  transport::EndCause cause_ = transport::EndCause::kClosed;
  bool last_ack_queued_ = false;
  bool follows_writes_ = false;
  bool unconfirmed_ = false;
};

}  // namespace uplink::session
