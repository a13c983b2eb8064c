#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "metrics/ledger.h"
#include "schema/judge.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "server/session/held_back.h"
#include "server/session/number_run.h"
#include "server/session/pending_batch.h"
#include "server/session/rcan_order.h"
#include "server/session/throttle.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// Processes the messages of a stream one by one: duplicate, missing or new; judged; live applied,
/// durable and rejected to the journal. It stops in the middle of a batch where the server must
/// hold the stream back, and goes on there.
///
/// Reject is the one place where a session decides a Reject.
///
/// Thread:  confined to the stream's thread.
class Intake final {
 public:
  /// `generation` as robot::RobotSessions::Begin gave it.
  Intake(const SessionContext& context, robot::Robot& robot, const model::SessionId& session,
         std::uint64_t generation);

  /// What processing messages asks of the stream.
  struct Processed {
    /// Rejects and Notices, in order; they go out before any later Ack.
    std::vector<v1::RelayResponse> frames;
    /// Messages that were judged or found duplicates.
    std::size_t messages = 0;
    /// A settled message came again: it is answered by an Ack even if the Ack does not grow.
    bool ack_owed = false;
    /// The robot is held by another process or stream: process nothing more.
    bool is_void = false;
  };

  /// A checked batch becomes the pending one. Must not be called while one is pending. The views
  /// must hold until Keep.
  void Begin(std::span<const UplinkView> uplinks, SteadyTime arrived, SystemTime received_at);
  /// Processes messages of the pending batch until it is done or the stream must be held back.
  /// `outgoing` is the number of frames that wait for the peer already.
  [[nodiscard]] Processed Process(std::size_t outgoing);
  [[nodiscard]] bool pending() const { return !batch_.empty(); }
  /// Copies what is still pending: the frame's bytes are about to go.
  void Keep() { batch_.Keep(); }
  /// Drops what is pending, unprocessed.
  void Drop() { batch_.Drop(); }

  /// No message is processed any more: the agent is to confirm Rejects first, by its next Hello.
  [[nodiscard]] bool rejects_full() const {
    return robot_.sessions.unconfirmed() >= context_.limits.unconfirmed_rejects_max;
  }
  /// Whether a message may be processed now, and what keeps it if not (HeldBackBy).
  [[nodiscard]] HeldBack HeldBackBy(std::size_t outgoing) const;
  /// When a throttled stream may go on (Throttle::end).
  [[nodiscard]] std::optional<SteadyTime> throttle_end() const { return throttle_.end(); }

 private:
  void ProcessUplink(const UplinkView& uplink, Processed& processed);
  void CountDuplicate(const robot::Seen& seen, Processed& processed);
  void AppendGap(const robot::Seen& seen);
  void JudgeRoverNexus(const UplinkView& uplink, Processed& processed);
  void JudgeRcan(const UplinkView& uplink, Processed& processed);
  void Accept(const UplinkView& uplink, model::Record& record, Processed& processed);
  void AddLive(model::Record record);
  void Reject(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
              Processed& processed);
  void TellDropped(model::Seq seq, std::span<const model::DroppedField> dropped, std::size_t kind,
                   Processed& processed);
  void Append(model::Seq seq, std::variant<model::Record, storage::QuarantineItem> content,
              std::string payload, std::size_t payload_bytes);
  void CountSuperseded();
  void ApplyLive();
  void Publish();

  const SessionContext& context_;
  robot::Robot& robot_;
  const storage::RobotRef id_;
  journal::Journal& journal_;
  const model::SessionId session_;
  const std::uint64_t generation_;

  PendingBatch batch_;
  NumberRun numbers_;
  Throttle throttle_;
  SteadyTime arrived_;
  SystemTime received_at_;
  bool sign_of_life_ = false;
  /// Once the stream has sent a Robot State.
  std::unique_ptr<RcanOrder> rcan_order_;
  metrics::UplinkCounts counts_;
};

}  // namespace uplink::session
