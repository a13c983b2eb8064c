#include "server/journal/quarantine_trim.h"

#include <cstddef>
#include <string>
#include <vector>

#include "server/journal/limits.h"
#include "storage/store.h"

namespace uplink::journal {

SteadyTime QuarantineTrim::due() const {
  return context_.quarantine.any() ? duty_.due() : Duty::kNever;
}

Step QuarantineTrim::Do() {
  const std::vector<std::string> ruris = context_.quarantine.First(kTrimRobotsPerCall);
  const auto trimmed = context_.store.TrimQuarantine(ruris);
  context_.errors.NoteDuty(trimmed.status());
  const SteadyTime now = context_.clock.Steady();
  if (!trimmed.ok()) {
    duty_.DueAt(now + kTrimInterval);
    return Step::kFailed;
  }
  for (std::size_t reason = 0; reason < trimmed->dropped.size(); ++reason) {
    context_.probe.quarantine_dropped[reason].Add(
        static_cast<std::int64_t>(trimmed->dropped[reason]));
  }
  auto unfinished = trimmed->unfinished.begin();
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    if (unfinished != trimmed->unfinished.end() && *unfinished == place) {
      ++unfinished;
    } else {
      context_.quarantine.Done(ruris[place]);
    }
  }
  duty_.DueAt(now + (context_.quarantine.any() ? kSweepAgain : kTrimInterval));
  return Step::kWorked;
}

}  // namespace uplink::journal
