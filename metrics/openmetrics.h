#pragma once

#include <span>
#include <string>

#include <prometheus/metric_family.h>

namespace uplink::metrics {

/// The families as OpenMetrics text 1.0.0, which prometheus-cpp does not write: a counter's family
/// is named without `_total`, and the text ends with `# EOF`.
[[nodiscard]] std::string OpenMetricsText(std::span<const prometheus::MetricFamily> families);

}  // namespace uplink::metrics
