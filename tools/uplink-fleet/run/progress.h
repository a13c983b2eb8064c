#pragma once

#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/report/live_summary.h"
#include "tools/uplink-fleet/report/progress_line.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/run/server_view.h"

namespace uplink::synthetic {

/// Shows people how a run goes, as often as the line on standard error takes it.
///
/// Thread: confined to main's thread.
class Progress final {
 public:
  /// All must outlive this.
  Progress(ServerView& view, const Clock& clock, const Shared& shared)
      : view_(view), clock_(clock), shared_(shared) {}

  /// Asks the server and shows what it and the robots do, if a line is due.
  void ShowStatus() {
    const SteadyTime now = clock_.Steady();
    if (!line_.Due(now)) return;
    const auto status = view_.Status();
    const auto page = view_.Metrics();
    line_.Show(summary_.Line(shared_, now, status.ok() ? std::optional(*status) : std::nullopt,
                             page.ok() ? std::optional(*page) : std::nullopt));
  }
  /// Shows `text`, if a line is due.
  void Tell(const std::string& text) {
    if (line_.Due(clock_.Steady())) line_.Show(text);
  }
  void Clear() const { line_.Clear(); }

 private:
  ServerView& view_;
  const Clock& clock_;
  const Shared& shared_;
  LiveSummary summary_;
  ProgressLine line_;
};

}  // namespace uplink::synthetic
