#include "server/journal/expiry_sweep.h"

#include "server/journal/limits.h"
#include "storage/store.h"

namespace uplink::journal {

Step ExpirySweep::Do() {
  const auto deleted = context_.store.Sweep(context_.clock.System());
  context_.errors.NoteDuty(deleted.status());
  const bool more = deleted.ok() && *deleted >= storage::kSweepRowsMax;
  duty_.DueAt(context_.clock.Steady() + (more ? kSweepAgain : kSweepInterval));
  if (!deleted.ok()) return Step::kFailed;
  context_.probe.expired_deleted.Add(static_cast<std::int64_t>(*deleted));
  return Step::kWorked;
}

}  // namespace uplink::journal
