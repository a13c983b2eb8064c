#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/compare/verify_twins.h"
#include "tools/uplink-fleet/report/process_use.h"
#include "tools/uplink-fleet/robot/histogram.h"

namespace uplink::synthetic {

/// What a run with twins did, beside the table. A value.
struct TwinFigures {
  std::uint64_t seed = 0;
  std::string run;
  /// For which messages were sent.
  double seconds = 0;
  TwinTotals totals;
  std::uint64_t connections = 0;
  /// Connections that ended on their own.
  std::uint64_t breaks = 0;
  /// Messages that were left out because broker or machine were too slow.
  std::uint64_t skipped = 0;
  bool restarted = false;
  /// From a ping to its pong, through the broker.
  Histogram pong;
  /// What the server's process used meanwhile; none if it runs elsewhere.
  std::optional<ProcessUse> server;
  ProcessUse own;
  /// First trouble that was overcome by reconnecting; empty if none.
  std::string first_error;
};

/// As TextReport and JsonReport (report/text_report.h, json_report.h). Pure.
[[nodiscard]] std::string TwinTextReport(const TwinFigures& figures,
                                         const std::vector<CheckRow>& rows,
                                         const Findings& findings);
[[nodiscard]] std::string TwinJsonReport(const TwinFigures& figures,
                                         const std::vector<CheckRow>& rows,
                                         const Findings& findings);

}  // namespace uplink::synthetic
