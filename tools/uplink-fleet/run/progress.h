#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/report/live_display.h"
#include "tools/uplink-fleet/report/live_summary.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/run/run_options.h"
#include "tools/uplink-fleet/run/server_view.h"

namespace uplink::synthetic {

/// Shows people how a run goes, as often as the display on standard error takes it.
///
/// Thread: confined to main's thread.
class Progress final {
 public:
  /// All but `options` must outlive this.
  Progress(ServerView& view, const Clock& clock, const Shared& shared, const RunOptions& options)
      : view_(view),
        clock_(clock),
        shared_(shared),
        run_for_(options.run_for),
        display_(options.errors) {}

  /// Asks the server and shows what it and the robots do, if a look is due.
  void ShowStatus() {
    const SteadyTime now = clock_.Steady();
    if (!display_.Due(now)) return;
    const auto status = view_.Status();
    const auto page = view_.Metrics();
    const LiveFigures figures =
        summary_.Take(shared_, now, status.ok() ? std::optional(*status) : std::nullopt,
                      page.ok() ? std::optional(*page) : std::nullopt);
    display_.Show(LineOf(figures), TableOf(figures, Heading(figures.seconds)));
  }
  /// Shows `text`, if a look is due.
  void Tell(const std::string& text) {
    if (display_.Due(clock_.Steady())) display_.Show(text);
  }
  void Clear() { display_.Clear(); }

 private:
  [[nodiscard]] std::string Heading(std::int64_t seconds) const {
    const bool sending = shared_.stage.load() == Stage::kRun;
    return sending ? SendingHeading("robots", seconds, run_for_) : SettlingHeading(seconds);
  }

  ServerView& view_;
  const Clock& clock_;
  const Shared& shared_;
  const milliseconds run_for_;
  LiveSummary summary_;
  LiveDisplay display_;
};

}  // namespace uplink::synthetic
