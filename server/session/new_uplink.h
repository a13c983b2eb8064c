#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "server/ingest/port.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "server/session/judged.h"
#include "server/session/live_intake.h"
#include "server/session/number_run.h"
#include "server/session/processed.h"
#include "server/session/range_appender.h"
#include "server/session/rcan_order.h"

namespace uplink::session {

/// What the new messages of one stream have in common. All of it outlives them.
struct UplinkSources {
  const SessionContext& context;
  robot::Robot& robot;
  model::SessionId session;
  ingest::Port& port;
  NumberRun& numbers;
  RangeAppender& ranges;
  LiveIntake& live;
};

/// A relayed message with a new number, as it is offered to the port.
///
/// Thread: confined to the stream's thread.
class NewUplink final : public ingest::Message {
 public:
  /// When its frame arrived.
  struct Arrived {
    SteadyTime steady;
    SystemTime system;
  };
  /// All of it outlives the message.
  NewUplink(const UplinkSources& sources, const UplinkView& uplink, const Arrived& arrived,
            const robot::Seen& seen, Judged& judged, Processed& processed);

  [[nodiscard]] const ingest::Arrival& arrival() const override { return arrival_; }
  [[nodiscard]] std::optional<ingest::RecordCost> Cost() override;
  /// The result of Cost, once it was called.
  [[nodiscard]] const ingest::RecordCost& cost() const { return cost_; }
  void Begin() override;
  [[nodiscard]] std::optional<model::Rejection> TakeRate() override;
  [[nodiscard]] ingest::Numbered RejectLimited(const model::Rejection& rejection) override;
  [[nodiscard]] const model::Rejection* FindRejection() override;
  [[nodiscard]] ingest::Quarantined Reject(const model::Rejection& rejection) override;
  [[nodiscard]] ingest::Brought Take() override;
  [[nodiscard]] ingest::Numbered Number(std::vector<storage::CommitRecord>& records,
                                        std::optional<model::RejectReason> rejected) override;
  /// Its number was settled when it was taken.
  void Settle(metrics::Became /*became*/) override {}

 private:
  /// Its number is past all that were decided before (RobotSessions::free_through): it counts for
  /// rates and the flow.
  [[nodiscard]] bool IsNew() const;
  /// The durable record that is stored unless it exceeds its rate; null for other messages.
  [[nodiscard]] const model::Record* Durable() const;
  [[nodiscard]] ingest::Brought TakeRecord(model::Record& record);

  const UplinkSources& sources_;
  const UplinkView& uplink_;
  const ingest::Arrival arrival_;
  const robot::Seen& seen_;
  Judged& judged_;
  Processed& processed_;
  ingest::RecordCost cost_;
  /// If it is limited: when it may come again.
  milliseconds again_{0};
  /// Of a Robot State.
  RcanOrder::Age age_ = RcanOrder::Age::kNewer;
  std::optional<model::Rejection> too_old_;
  /// For a record of a kind whose latest message the store keeps.
  std::optional<storage::LatestKind> latest_;
};

}  // namespace uplink::session
