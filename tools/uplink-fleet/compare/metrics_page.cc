#include "tools/uplink-fleet/compare/metrics_page.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <system_error>

namespace uplink::synthetic {
namespace {

/// What follows the metric's name on a line.
std::optional<Sample> SampleIn(std::string_view rest) {
  const std::size_t space = rest.rfind(' ');
  if (space == std::string_view::npos) return std::nullopt;
  std::string_view labels = rest.substr(0, space);
  if (!labels.empty()) {
    if (!labels.starts_with('{') || !labels.ends_with('}')) return std::nullopt;
    labels = labels.substr(1, labels.size() - 2);
  }
  const std::string_view text = rest.substr(space + 1);
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc() || value < 0 || !std::isfinite(value)) return std::nullopt;
  return Sample{labels, value};
}

}  // namespace

std::string_view Sample::Label(std::string_view name) const {
  const std::string begin = std::string(name) + "=\"";
  const std::size_t at = labels.find(begin);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = labels.substr(at + begin.size());
  return rest.substr(0, rest.find('"'));
}

std::vector<Sample> SamplesOf(std::string_view page, std::string_view name) {
  std::vector<Sample> samples;
  while (!page.empty()) {
    const std::size_t end = page.find('\n');
    const std::string_view line = page.substr(0, end);
    page.remove_prefix(end == std::string_view::npos ? page.size() : end + 1);
    if (!line.starts_with(name)) continue;
    if (const auto sample = SampleIn(line.substr(name.size()))) samples.push_back(*sample);
  }
  return samples;
}

}  // namespace uplink::synthetic
