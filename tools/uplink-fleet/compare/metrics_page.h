#pragma once

#include <string_view>
#include <vector>

namespace uplink::synthetic {

/// One line of a page of metrics. Views into the page.
struct Sample {
  /// Without the braces.
  std::string_view labels;
  double value = 0;

  /// What it has for that label; empty if it has none.
  [[nodiscard]] std::string_view Label(std::string_view name) const;
};

/// Those of that metric in the Prometheus text format; what is no number of at least zero is left
/// out. Pure; any thread.
[[nodiscard]] std::vector<Sample> SamplesOf(std::string_view page, std::string_view name);

}  // namespace uplink::synthetic
