#include "tools/uplink-fleet/run/progress.h"

#include <optional>
#include <utility>

namespace uplink::synthetic {

void Progress::TellHowItGoes() {
  const SteadyTime now = clock_.Steady();
  if (!line_.Due(now)) return;
  absl::StatusOr<v1::ServerStatus> status = view_.Status();
  absl::StatusOr<std::string> page = view_.Metrics();
  line_.Show(summary_.Line(shared_, now,
                           status.ok() ? std::optional(*std::move(status)) : std::nullopt,
                           page.ok() ? std::optional(*std::move(page)) : std::nullopt));
}

void Progress::Tell(const std::string& text) {
  if (line_.Due(clock_.Steady())) line_.Show(text);
}

}  // namespace uplink::synthetic
