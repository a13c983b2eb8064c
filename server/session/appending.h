#pragma once

#include "server/ingest/port.h"
#include "server/robot/robot.h"
#include "server/session/limited_run.h"
#include "server/session/number_run.h"

namespace uplink::session {

/// What of a stream's numbers goes to the journal besides its messages, in their order: gaps, and
/// ranges of numbers that were limited.
///
/// Thread: confined to the stream's thread.
class Appending final {
 public:
  /// `port` and `numbers` outlive it.
  Appending(ingest::Line line, ingest::Port& port, NumberRun& numbers)
      : line_(std::move(line)), port_(port), numbers_(numbers) {}

  /// What follows came with a frame that arrived at this time.
  void Begin(SteadyTime arrived, SystemTime received_at) {
    arrived_ = arrived;
    received_at_ = received_at;
  }
  /// What the numbers that are missing before the one just seen cost; of no bytes if none are.
  [[nodiscard]] ingest::RecordCost CostOfGap(const robot::Seen& seen) const;
  /// The numbers that are missing before the one just seen, if any are.
  void AddGap(const robot::Seen& seen);
  /// The number just seen, of a durable message that was limited: it goes with its range.
  [[nodiscard]] ingest::Numbered AddLimited(robot::RejectedSeq limited);
  /// The number of a limited message goes on with the range at hand.
  [[nodiscard]] bool Continues(model::Seq seq) const { return limited_.Precedes(seq); }
  /// The range at hand goes too. Ends a pass.
  void Flush();

 private:
  /// The flow counts a gap up to this number: it was not decided before.
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
