#include "server/journal/retention.h"

#include "server/journal/limits.h"
#include "storage/store.h"

namespace uplink::journal {

Step Retention::Do() {
  const auto deleted = context_.store.Retain(context_.clock.System());
  const SteadyTime now = context_.clock.Steady();
  if (absl::IsUnavailable(deleted.status())) {
    context_.errors.NoteDuty(deleted.status());
    duty_.DueAt(now + kRetainAgain);
    return Step::kFailed;
  }
  context_.retain_error.Note(deleted.status());
  if (!deleted.ok()) {
    // Commits go on: they are not affected.
    duty_.DueAt(now + kRetainLater);
    return Step::kWorked;
  }
  context_.errors.NoteDuty(absl::OkStatus());
  context_.probe.history_deleted.Add(static_cast<std::int64_t>(deleted->rows));
  context_.probe.rejects_kept.Add(static_cast<std::int64_t>(deleted->rejects_kept));
  if (deleted->more) {
    duty_.DueAt(now + kSweepAgain);
  } else {
    duty_.DueAt(now + kRetainInterval);
  }
  return Step::kWorked;
}

}  // namespace uplink::journal
