#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "server/ingest/port.h"
#include "server/journal/entry.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "server/session/live_intake.h"
#include "server/session/new_uplink.h"
#include "server/session/number_run.h"
#include "server/session/pending_batch.h"
#include "server/session/processed.h"
#include "server/session/range_appender.h"
#include "server/session/stream_timers.h"

namespace uplink::session {

/// What blocks every message of a robot's stream, whatever it is: the peer does not read
/// (`outgoing` frames wait for it), or sends too much that is malformed or over its rate.
[[nodiscard]] ingest::Block FindBlockOfAll(const robot::Robot& robot, std::size_t outgoing,
                                           SteadyTime now);

/// Processes the messages of a stream one by one. It counts duplicates, and appends the gap before
/// a new message, judges it, and offers it to the port. It stops in the middle of a batch if the
/// server must hold the stream back, and goes on there.
///
/// Thread:  confined to the stream's thread.
class Intake final {
 public:
  /// The references outlive it; `by` as Attachment::Open returned it.
  struct Sources {
    const SessionContext& context;
    robot::Robot& robot;
    StreamTimers& timers;
    const model::SessionId& session;
    journal::AppendedBy by;
  };
  explicit Intake(const Sources& sources);

  using Processed = session::Processed;

  /// Begins a checked batch. None may be pending. The views must stay valid until Keep.
  void Begin(std::span<const UplinkView> uplinks, SteadyTime arrived, SystemTime received_at);
  /// Processes messages of the pending batch until it is done or the stream must be held back.
  /// `outgoing` frames already wait for the peer.
  [[nodiscard]] Processed Process(std::size_t outgoing);
  [[nodiscard]] bool pending() const { return !batch_.empty(); }
  /// Process has something to do: messages are pending, or telemetry over the rate may be decoded
  /// by now (Timer::kSurplus).
  [[nodiscard]] bool due() const { return pending() || MayDecodeSurplus(); }
  /// Copies pending messages: the frame's bytes are about to go.
  void Keep() { batch_.Keep(); }
  /// Drops pending messages unprocessed.
  void Drop() {
    batch_.Drop();
    front_cost_.reset();
  }
  /// The stream ends: the latest telemetry that was over the rate is applied.
  void End();

  /// No more messages are processed: the agent must first confirm Rejects, by its next Hello.
  [[nodiscard]] bool rejects_full() const {
    return robot_.sessions.unconfirmed() >= context_.limits.unconfirmed_rejects_max;
  }
  /// Processing has stopped so that other streams of the thread have their turn: call it again
  /// soon.
  [[nodiscard]] bool yields() const { return costly_ >= kCostlyPerTurn; }
  /// Why the next message must wait; includes the limits of a record if one is pending. `outgoing`
  /// as Process.
  [[nodiscard]] ingest::Block FindBlock(std::size_t outgoing);

 private:
  [[nodiscard]] bool MayDecodeSurplus() const;
  /// False if the message has to wait.
  [[nodiscard]] bool ProcessUplink(const UplinkView& uplink, Processed& processed);
  /// Telemetry over the rate of its robot is superseded undecoded. False if it has to wait.
  [[nodiscard]] bool AddUndecoded(std::size_t kind, const UplinkView& uplink,
                                  const robot::Seen& seen);
  /// False, and the message waits, if its cost has no room.
  [[nodiscard]] bool HasRoom(const ingest::RecordCost& cost);
  void WaitFor(const ingest::RecordCost& cost);
  void CountDuplicate(const robot::Seen& seen, Processed& processed);

  const SessionContext& context_;
  robot::Robot& robot_;
  StreamTimers& timers_;
  const ingest::Line line_;

  ingest::Port port_;
  PendingBatch batch_;
  NumberRun numbers_;
  RangeAppender ranges_;
  LiveIntake live_;
  const UplinkSources uplinks_;
  /// The cost of the next message, if it had to wait.
  std::optional<ingest::RecordCost> front_cost_;
  NewUplink::Arrived arrived_;
  /// Messages of this turn that were rejected, limited, or had invalid fields.
  std::size_t costly_ = 0;
};

}  // namespace uplink::session
