#include "tools/uplink-fleet/compare/mqtt_counts.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace uplink::synthetic {
namespace {

constexpr std::string_view kReceived = "uplinkd_mqtt_messages_received_total";
constexpr std::string_view kSettled = "uplinkd_mqtt_messages_settled_total";
constexpr std::string_view kInFlight = "uplinkd_mqtt_messages_in_flight";
constexpr std::string_view kOutcome = "outcome=\"";

/// One line of a page: name, labels and value.
struct Sample {
  std::string_view name;
  std::string_view labels;
  std::uint64_t value = 0;
};

std::optional<Sample> SampleOf(std::string_view line) {
  const std::size_t space = line.rfind(' ');
  if (line.starts_with('#') || space == std::string_view::npos) return std::nullopt;
  const std::string_view series = line.substr(0, space);
  const std::string_view text = line.substr(space + 1);
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc() || value < 0 || !std::isfinite(value)) return std::nullopt;
  const std::size_t brace = series.find('{');
  Sample sample{.name = series.substr(0, brace), .labels = {}};
  if (brace != std::string_view::npos) sample.labels = series.substr(brace + 1);
  sample.value = static_cast<std::uint64_t>(std::llround(value));
  return sample;
}

std::string OutcomeIn(std::string_view labels) {
  const std::size_t at = labels.find(kOutcome);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = labels.substr(at + kOutcome.size());
  return std::string(rest.substr(0, rest.find('"')));
}

}  // namespace

std::optional<MqttCounts> MqttCountsOf(std::string_view page) {
  MqttCounts counts;
  bool received = false;
  bool in_flight = false;
  while (!page.empty()) {
    const std::size_t end = page.find('\n');
    const std::optional<Sample> sample = SampleOf(page.substr(0, end));
    page.remove_prefix(end == std::string_view::npos ? page.size() : end + 1);
    if (!sample) continue;
    if (sample->name == kReceived) {
      counts.received += sample->value;
      received = true;
    } else if (sample->name == kInFlight) {
      counts.in_flight += sample->value;
      in_flight = true;
    } else if (sample->name == kSettled) {
      counts.settled[OutcomeIn(sample->labels)] += sample->value;
    }
  }
  if (!received || !in_flight || counts.settled.empty()) return std::nullopt;
  return counts;
}

}  // namespace uplink::synthetic
