#include "server/session/appending.h"

#include <utility>

namespace uplink::session {

void Appending::AddGap(const robot::Seen& seen) {
  sources_.counts.missing += seen.missing;
  sources_.robot.sessions.AddGap(sources_.session, seen);
  journal_.AppendGap(sources_.robot, sources_.by,
                     {.robot = id_,
                      .session = sources_.session,
                      .first = seen.missing_first,
                      .last = seen.missing_last,
                      .seen_at = received_at_});
}

void Appending::Add(model::Seq seq, storage::CommitContent content, std::string payload,
                    std::size_t payload_bytes) {
  Flush();
  storage::CommitRecord record{.robot = id_,
                               .session = sources_.session,
                               .seq = seq,
                               .received_at = received_at_,
                               .content = std::move(content),
                               .payload = std::move(payload),
                               .payload_bytes = payload_bytes};
  if (Wait(seq, journal::CostOf(record))) Append(std::move(record));
}

void Appending::AddLimited(robot::RejectedSeq limited) {
  if (!Continues(limited.seq)) Flush();
  if (!Wait(limited.seq, limited_.empty() ? robot::kRecordOverheadBytes : 0)) return;
  limited_.Add(limited.seq, limited.rejection);
  sources_.robot.sessions.Remember(sources_.session, std::move(limited));
}

void Appending::Flush() {
  if (limited_.empty()) return;
  const model::Seq last = limited_.last();
  Append({.robot = id_,
          .session = sources_.session,
          .seq = last,
          .received_at = received_at_,
          .content = limited_.Take(),
          .payload = {}});
}

bool Appending::Wait(model::Seq seq, std::size_t bytes) {
  ++sources_.counts.received;
  const std::int64_t grew = sources_.numbers.AddWaiting(seq, bytes);
  if (grew == 0) ++sources_.counts.superseded;
  sources_.counts.in_flight += grew;
  return grew > 0;
}

void Appending::Append(storage::CommitRecord record) {
  // Published before the writer can settle it, so that no scrape sees it settled and not received.
  Publish();
  journal_.Append(sources_.robot, sources_.by, std::move(record), arrived_);
}

void Appending::Publish() {
  sources_.context.ledger.Publish(sources_.counts);
  sources_.counts = {};
}

}  // namespace uplink::session
