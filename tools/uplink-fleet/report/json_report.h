#pragma once

#include <string>
#include <vector>

#include <google/protobuf/struct.pb.h>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/report/run_figures.h"

namespace uplink::synthetic {

/// The figures, the table and what differs as one JSON object:
/// `{"ok":...,"run":{...},"checks":[...],"differences":[...]}`.
[[nodiscard]] std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                                     const Findings& findings);

/// The same for a run whose figures are already an object.
[[nodiscard]] std::string JsonOf(google::protobuf::Struct run, const std::vector<CheckRow>& rows,
                                 const Findings& findings);

}  // namespace uplink::synthetic
