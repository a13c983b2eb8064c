#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

/// Differences that the text shows; the JSON shows all that are kept.
inline constexpr std::size_t kDifferencesShown = 20;

/// The table for people, with what differs robot by robot, ending with one line that says whether
/// all agree.
[[nodiscard]] std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);

/// The same for a run with twins.
[[nodiscard]] std::string TextReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);
/// The same for a run with drones.
[[nodiscard]] std::string TextReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);

}  // namespace uplink::synthetic
