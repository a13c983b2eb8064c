#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "metrics/ledger.h"
#include "schema/judge.h"
#include "server/journal/appended_by.h"
#include "server/robot/robot.h"
#include "server/session/appending.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "server/session/held_back.h"
#include "server/session/judged.h"
#include "server/session/live_intake.h"
#include "server/session/number_run.h"
#include "server/session/pending_batch.h"
#include "server/session/processed.h"
#include "server/session/stream_timers.h"

namespace uplink::session {

/// Processes the messages of a stream one by one: duplicate, missing or new; judged; live applied,
/// durable and rejected to the journal. It stops in the middle of a batch where the server must
/// hold the stream back, and goes on there.
///
/// Reject and Limit are the two places where a session decides a Reject.
///
/// Thread:  confined to the stream's thread.
class Intake final {
 public:
  /// What outlives it, and `by` as Attachment::Open gave it.
  struct Sources {
    const SessionContext& context;
    robot::Robot& robot;
    StreamTimers& timers;
    const model::SessionId& session;
    journal::AppendedBy by;
  };
  explicit Intake(const Sources& sources);

  using Processed = session::Processed;

  /// A checked batch becomes the pending one. Must not be called while one is pending. The views
  /// must hold until Keep.
  void Begin(std::span<const UplinkView> uplinks, SteadyTime arrived, SystemTime received_at);
  /// Processes messages of the pending batch until it is done or the stream must be held back.
  /// `outgoing` is the number of frames that wait for the peer already.
  [[nodiscard]] Processed Process(std::size_t outgoing);
  [[nodiscard]] bool pending() const { return !batch_.empty(); }
  /// Process has something to do: messages are pending, or telemetry over the rate may be decoded
  /// by now (Timer::kSurplus).
  [[nodiscard]] bool due() const { return pending() || MayDecodeSurplus(); }
  /// Copies what is still pending: the frame's bytes are about to go.
  void Keep() { batch_.Keep(); }
  /// Drops what is pending, unprocessed.
  void Drop() {
    batch_.Drop();
    front_cost_.reset();
  }
  /// The stream ends: the latest telemetry that was over the rate is applied.
  void End();

  /// No message is processed any more: the agent is to confirm Rejects first, by its next Hello.
  [[nodiscard]] bool rejects_full() const {
    return robot_.sessions.unconfirmed() >= context_.limits.unconfirmed_rejects_max;
  }
  /// Processing has stopped so that other streams of the thread have their turn: call it again
  /// soon.
  [[nodiscard]] bool yields() const { return costly_ >= kCostlyPerTurn; }
  /// What keeps the next message from being processed: of one that is not here yet, what keeps any;
  /// of one at which processing stopped, also what keeps a record like it.
  [[nodiscard]] Hold HoldNow(std::size_t outgoing);

 private:
  [[nodiscard]] bool MayDecodeSurplus() const;
  /// False if the message has to wait.
  [[nodiscard]] bool ProcessUplink(const UplinkView& uplink, Processed& processed);
  /// What it costs, with the gap before it; of no bytes if nothing is to be appended.
  [[nodiscard]] RecordCost CostOf(const UplinkView& uplink, const robot::Seen& seen,
                                  const Judged& judged) const;
  /// What the numbers that are missing before it cost.
  [[nodiscard]] RecordCost CostOfGap(const robot::Seen& seen) const;
  /// False, and the message waits, if a record of that cost has to.
  [[nodiscard]] bool HasRoom(const RecordCost& cost);
  void AddGap(const robot::Seen& seen);
  [[nodiscard]] HeldBackSources HoldSources() const;
  /// It was not decided before: neither sent again, nor before the store has said how far it is.
  [[nodiscard]] bool IsNew(model::Seq seq) const { return seq > robot_.sessions.free_through(); }
  void TakeFlow(std::size_t bytes) {
    robot_.flow.Take(bytes, allowance_->flow, context_.clock.Steady());
  }
  void CountDuplicate(const robot::Seen& seen, Processed& processed);
  void Accept(const UplinkView& uplink, Judged& judged, Processed& processed);
  void AcceptRecord(const UplinkView& uplink, model::Record& record, bool expired,
                    Processed& processed);
  void AcceptState(const UplinkView& uplink, Judged& judged, Processed& processed);
  /// True if the message is over its variant's rate: it is rejected. The number of a live one is
  /// settled, that of a durable one waits for the commit of its range.
  [[nodiscard]] bool Limit(const UplinkView& uplink, const model::Record& record,
                           Processed& processed);
  void Reject(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
              Processed& processed);

  const SessionContext& context_;
  robot::Robot& robot_;
  StreamTimers& timers_;
  const storage::RobotRef id_;
  journal::Journal& journal_;
  const model::SessionId session_;
  const journal::GatewayRef gateway_;

  PendingBatch batch_;
  NumberRun numbers_;
  metrics::MessageCounts counts_;
  Appending appending_;
  LiveIntake live_;
  /// What every robot may send, and of which version of it that is.
  std::shared_ptr<const Allowance> allowance_;
  std::uint64_t allowance_version_ = 0;
  /// What the next message costs, which had to wait.
  std::optional<RecordCost> front_cost_;
  SteadyTime arrived_;
  SystemTime received_at_;
  /// Messages of this turn that were rejected, limited, or had invalid fields.
  std::size_t costly_ = 0;
};

}  // namespace uplink::session
