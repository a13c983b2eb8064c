#include "server/journal/expiry_sweep.h"

#include <algorithm>
#include <cstddef>

#include "server/journal/limits.h"
#include "storage/store.h"

namespace uplink::journal {

Step ExpirySweep::Do() {
  const SystemTime now = context_.clock.System();
  const auto deleted = context_.store.Sweep(now);
  auto closed = deleted;
  if (deleted.ok()) closed = context_.store.CloseRuns(now);
  context_.errors.NoteDuty(closed.status());
  const std::size_t most = std::max(deleted.value_or(0), closed.value_or(0));
  duty_.DueAt(context_.clock.Steady() +
              (most >= storage::kSweepRowsMax ? kSweepAgain : kSweepInterval));
  context_.probe.expired_deleted.Add(static_cast<std::int64_t>(deleted.value_or(0)));
  if (!closed.ok()) return Step::kFailed;
  context_.probe.runs_closed_for_age.Add(static_cast<std::int64_t>(*closed));
  return Step::kWorked;
}

}  // namespace uplink::journal
