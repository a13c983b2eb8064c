#include "server/journal/expiry_sweep.h"

#include <algorithm>
#include <cstddef>

#include "server/journal/limits.h"
#include "storage/shared_items.h"
#include "storage/store.h"

namespace uplink::journal {

Step ExpirySweep::Do() {
  const SystemTime now = context_.clock.System();
  const auto swept = context_.store.Sweep(now);
  const auto closed =
      swept.ok() ? context_.store.CloseRuns(now) : absl::StatusOr<std::size_t>(swept.status());
  context_.errors.NoteDuty(closed.status());
  const storage::Swept went = swept.value_or(storage::Swept());
  const bool more = std::max(went.items, closed.value_or(0)) >= storage::kSweepRowsMax ||
                    went.changes >= storage::kChangesSweptMax;
  duty_.DueAt(context_.clock.Steady() + (more ? kSweepAgain : kSweepInterval));
  context_.probe.expired_deleted.Add(static_cast<std::int64_t>(went.items));
  if (!closed.ok()) return Step::kFailed;
  context_.probe.runs_closed_for_age.Add(static_cast<std::int64_t>(*closed));
  return Step::kWorked;
}

}  // namespace uplink::journal
