#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/terminal/terminal.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

/// Differences that the text shows; the JSON shows all that are kept.
inline constexpr std::size_t kDifferencesShown = 20;

/// How the run went and the table for people, with what differs robot by robot, ending with one
/// line that says whether all agree. Pure.
[[nodiscard]] std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings, const Palette& palette);
/// The same for a run with twins.
[[nodiscard]] std::string TextReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings, const Palette& palette);
/// The same for a run with drones.
[[nodiscard]] std::string TextReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings, const Palette& palette);

}  // namespace uplink::synthetic
