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

/// The table alone, what differs, and the line; `first_error` is said if something differs.
[[nodiscard]] std::string TableText(const std::vector<CheckRow>& rows, const Findings& findings,
                                    const std::string& first_error);

}  // namespace uplink::synthetic
