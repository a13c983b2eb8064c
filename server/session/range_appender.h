#pragma once

#include "server/ingest/port.h"
#include "server/robot/robot.h"
#include "server/session/limited_run.h"
#include "server/session/number_run.h"

namespace uplink::session {

/// Appends a stream's gaps, and ranges of limited numbers, to the journal, in the order of its
/// messages.
///
/// Thread: confined to the stream's thread.
class RangeAppender final {
 public:
  /// `port` and `numbers` outlive it.
  RangeAppender(ingest::Line line, ingest::Port& port, NumberRun& numbers)
      : line_(std::move(line)), port_(port), numbers_(numbers) {}

  /// Begins a frame that arrived at this time.
  void Begin(SteadyTime arrived, SystemTime received_at) {
    arrived_ = arrived;
    received_at_ = received_at;
  }
  /// The cost of the numbers missing before the one just seen; no bytes if none are.
  [[nodiscard]] ingest::RecordCost CostOfGap(const robot::Seen& seen) const;
  /// Appends the numbers missing before the one just seen, if any.
  void AddGap(const robot::Seen& seen);
  /// Adds the number just seen, of a limited durable message; it is appended with its range.
  [[nodiscard]] ingest::Numbered AddLimited(robot::RejectedSeq limited);
  /// Whether the number of a limited message continues the current range.
  [[nodiscard]] bool Continues(model::Seq seq) const { return limited_.Precedes(seq); }
  /// Appends the current range too. Ends a pass.
  void Flush();

 private:
  /// Whether the flow counts a gap up to this number: it was not decided before.
  [[nodiscard]] bool IsNew(model::Seq seq) const {
    return seq > line_.robot.sessions.free_through();
  }

  const ingest::Line line_;
  ingest::Port& port_;
  NumberRun& numbers_;
  LimitedRun limited_;
  SteadyTime arrived_;
  SystemTime received_at_;
};

}  // namespace uplink::session
