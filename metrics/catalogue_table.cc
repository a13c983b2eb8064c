// The catalogue as text: a table for people.
#include <fmt/core.h>

#include "metrics/catalogue.h"

namespace uplink::metrics {
namespace {

std::string LabelsText(const MetricSpec& spec) {
  std::string text;
  for (const std::string_view label : spec.labels) {
    if (!text.empty()) text += ", ";
    text += fmt::format("`{}`", label);
  }
  return text;
}

}  // namespace

std::string_view ToText(MetricType type) {
  switch (type) {
    case MetricType::kCounter:
      return "counter";
    case MetricType::kGauge:
      return "gauge";
    case MetricType::kHistogram:
      return "histogram";
  }
  return "";
}

std::string CatalogueTable() {
  std::string table =
      "| name | type | unit | labels | is | since |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const MetricSpec& spec : Catalogue()) {
    table += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", spec.name, ToText(spec.type),
                         spec.unit, LabelsText(spec), spec.help, spec.since);
  }
  return table;
}

}  // namespace uplink::metrics
