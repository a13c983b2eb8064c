#pragma once

#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

/// The figures, the table and what differs as one JSON object:
/// `{"ok":...,"run":{...},"checks":[...],"differences":[...]}`. Pure.
[[nodiscard]] std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);
/// The same for a run with twins.
[[nodiscard]] std::string JsonReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);
/// The same for a run with drones.
[[nodiscard]] std::string JsonReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);

}  // namespace uplink::synthetic
