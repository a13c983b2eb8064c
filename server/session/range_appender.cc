#include "server/session/range_appender.h"

#include <utility>
#include <vector>

namespace uplink::session {

ingest::RecordCost RangeAppender::CostOfGap(const robot::Seen& seen) const {
  ingest::RecordCost cost;
  if (seen.missing_first == 0) return cost;
  cost.journal_bytes = robot::kRecordOverheadBytes;
  if (IsNew(seen.missing_last)) cost.flow_bytes = 0;
  return cost;
}

void RangeAppender::AddGap(const robot::Seen& seen) {
  if (seen.missing_first == 0) return;
  if (IsNew(seen.missing_last)) port_.TakeFlow(line_, ingest::Waits::kStream, 0);
  port_.counts().missing += seen.missing;
  line_.robot.sessions.AddGap(line_.session, seen);
  line_.journal.AppendGap(line_.robot, line_.by,
                          {.robot = line_.id,
                           .session = line_.session,
                           .first = seen.missing_first,
                           .last = seen.missing_last,
                           .seen_at = received_at_});
}

ingest::Numbered RangeAppender::AddLimited(robot::RejectedSeq limited) {
  if (!Continues(limited.seq)) {
    port_.TakeFlow(line_, ingest::Waits::kStream, 0);
    Flush();
  }
  const std::size_t bytes = limited_.empty() ? robot::kRecordOverheadBytes : 0;
  if (numbers_.AddWaiting(limited.seq, bytes) == 0) return ingest::Numbered::kLost;
  limited_.Add(limited.seq, limited.rejection);
  line_.robot.sessions.Remember(line_.session, std::move(limited));
  return ingest::Numbered::kWaiting;
}

void RangeAppender::Flush() {
  if (limited_.empty()) return;
  std::vector<storage::CommitRecord> range;
  range.push_back({.robot = line_.id,
                   .session = line_.session,
                   .seq = limited_.last(),
                   .received_at = received_at_,
                   .content = limited_.Take(),
                   .payload = {}});
  port_.Append(line_, std::move(range), arrived_);
}

}  // namespace uplink::session
