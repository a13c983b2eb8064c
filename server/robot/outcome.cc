#include "server/robot/outcome.h"

#include <cstddef>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

void CountRejected(model::RejectReason reason, std::size_t messages,
                   metrics::MessageCounts& counts) {
  counts.rejected += messages;
  counts.rejects[static_cast<std::size_t>(reason)] += messages;
}

}  // namespace

void ApplyOutcome(const Settled& settled, std::size_t messages, RejectMemory& rejects,
                  metrics::MessageCounts& counts) {
  switch (settled.outcome.kind) {
    case storage::OutcomeKind::kStored:
      if (settled.rejected_for) {
        CountRejected(*settled.rejected_for, messages, counts);
      } else {
        counts.stored += messages;
      }
      return;
    case storage::OutcomeKind::kDuplicate:
      counts.duplicate += messages;
      return;
    case storage::OutcomeKind::kRefused:
      UPLINK_CHECK(settled.outcome.rejection.has_value(), "a refused record has its reason");
      CountRejected(settled.rejected_for.value_or(settled.outcome.rejection->reason), messages,
                    counts);
      // A rejection by judgement was already reported and remembered.
      if (!settled.rejected_for) {
        rejects.AddUntold(FromStore(settled.seq, *settled.outcome.rejection));
      }
      return;
    case storage::OutcomeKind::kFenced:
      break;
  }
  UPLINK_CHECK(false, "fenced records are told by OnFenced");
}

metrics::MessageCounts SupersededCounts(std::size_t messages) {
  metrics::MessageCounts counts;
  counts.superseded += messages;
  counts.in_flight -= static_cast<std::int64_t>(messages);
  return counts;
}

}  // namespace uplink::robot
