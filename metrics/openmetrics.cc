#include "metrics/openmetrics.h"

#include <cmath>
#include <string_view>

#include <fmt/core.h>

#include "metrics/format.h"

namespace uplink::metrics {
namespace {

constexpr std::string_view kTotal = "_total";

std::string NumberText(double value) {
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  if (std::isnan(value)) return "NaN";
  return fmt::format("{}", value);
}

/// `{a="1",le="2"}`; nothing without labels.
std::string LabelsText(const prometheus::ClientMetric& metric, std::string_view bound = {}) {
  std::string text;
  for (const prometheus::ClientMetric::Label& label : metric.label) {
    text += text.empty() ? "{" : ",";
    text += label.name + "=\"";
    AppendEscaped(text, label.value);
    text += '"';
  }
  if (!bound.empty()) text += fmt::format("{}le=\"{}\"", text.empty() ? "{" : ",", bound);
  return text.empty() ? text : text + "}";
}

void AppendHistogram(const std::string& name, const prometheus::ClientMetric& metric,
                     std::string& text) {
  const auto& histogram = metric.histogram;
  for (const auto& bucket : histogram.bucket) {
    // A bound is a number with a point there.
    std::string bound = NumberText(bucket.upper_bound);
    if (bound.find_first_of(".eI") == std::string::npos) bound += ".0";
    text +=
        fmt::format("{}_bucket{} {}\n", name, LabelsText(metric, bound), bucket.cumulative_count);
  }
  const std::string labels = LabelsText(metric);
  text += fmt::format("{}_count{} {}\n", name, labels, histogram.sample_count);
  text += fmt::format("{}_sum{} {}\n", name, labels, NumberText(histogram.sample_sum));
}

void AppendFamily(const prometheus::MetricFamily& family, std::string& text) {
  const bool counter = family.type == prometheus::MetricType::Counter;
  const bool histogram = family.type == prometheus::MetricType::Histogram;
  std::string name = family.name;
  if (counter && name.ends_with(kTotal)) name.resize(name.size() - kTotal.size());
  text += fmt::format("# HELP {} {}\n", name, family.help);
  text += fmt::format("# TYPE {} {}\n", name,
                      counter     ? "counter"
                      : histogram ? "histogram"
                                  : "gauge");
  for (const prometheus::ClientMetric& metric : family.metric) {
    if (histogram) {
      AppendHistogram(name, metric, text);
      continue;
    }
    const double value = counter ? metric.counter.value : metric.gauge.value;
    text += fmt::format("{}{}{} {}\n", name, counter ? kTotal : "", LabelsText(metric),
                        NumberText(value));
  }
}

}  // namespace

std::string OpenMetricsText(std::span<const prometheus::MetricFamily> families) {
  std::string text;
  for (const prometheus::MetricFamily& family : families) AppendFamily(family, text);
  return text + "# EOF\n";
}

}  // namespace uplink::metrics
