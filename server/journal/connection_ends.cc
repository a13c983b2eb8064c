#include "server/journal/connection_ends.h"

#include <cstdint>

#include "server/journal/limits.h"
#include "storage/bounds.h"
#include "storage/store.h"

namespace uplink::journal {

Step ConnectionEnds::Do() {
  const auto processes = context_.store.ProcessesWithOpenConnections();
  absl::Status status = processes.status();
  bool again = false;
  if (processes.ok()) {
    for (const storage::ProcessId& process : *processes) {
      const std::optional<bool> over = is_over_(process);
      again = again || !over;
      if (!over.value_or(false)) continue;
      const auto ended = context_.store.EndConnections(process, context_.clock.System());
      status = ended.status();
      if (!status.ok()) break;
      context_.probe.connections_ended.Add(static_cast<std::int64_t>(*ended));
      // One slice a turn: commits wait meanwhile.
      again = again || *ended > 0;
      if (*ended > 0) break;
    }
  }
  context_.errors.NoteDuty(status);
  duty_.DueAt(context_.clock.Steady() + (again ? kEndsAgain : kSweepInterval));
  return status.ok() ? Step::kWorked : Step::kFailed;
}

}  // namespace uplink::journal
