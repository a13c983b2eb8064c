#include "tools/uplink-fleet/scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/core.h>
#include <toml++/toml.h>

namespace uplink::synthetic {
namespace {

struct Key {
  ScenarioNumber number;
  bool whole;
  void (*set)(Scenario& scenario, double value);
};

constexpr std::array<Key, 7> kKeys = {{
    {kRobotsNumber, true,
     [](Scenario& to, double value) { to.robots = static_cast<std::size_t>(value); }},
    {kRateNumber, false, [](Scenario& to, double value) { to.options.rate_hz = value; }},
    {kFaultsNumber, false, [](Scenario& to, double value) { to.options.faults_hz = value; }},
    {kMalformedNumber, false,
     [](Scenario& to, double value) { to.options.malformed_share = value; }},
    {kBreaksNumber, false, [](Scenario& to, double value) { to.breaks_per_minute = value; }},
    {kBatchNumber, true,
     [](Scenario& to, double value) { to.batch = static_cast<std::size_t>(value); }},
    {kPaceNumber, false, [](Scenario& to, double value) { to.options.pace = value; }},
}};

absl::Status Invalid(const std::string& text) { return absl::InvalidArgumentError(text); }

absl::Status Apply(const std::string& path, const std::string& name, const toml::node& node,
                   Scenario& scenario) {
  const auto* key =
      std::ranges::find_if(kKeys, [&](const Key& each) { return each.number.key == name; });
  if (key == kKeys.end()) return Invalid(fmt::format("{}: no such key: {}", path, name));
  const auto value = node.value<double>();
  const ScenarioNumber& limits = key->number;
  if (!value || !(*value >= limits.min && *value <= limits.max) ||
      (key->whole && *value != std::floor(*value))) {
    return Invalid(fmt::format("{}: {} takes a {}number from {} to {}", path, name,
                               key->whole ? "whole " : "", limits.min, limits.max));
  }
  key->set(scenario, *value);
  return absl::OkStatus();
}

Scenario Make(double rate_hz, double faults_hz, double malformed_share, double breaks) {
  Scenario scenario;
  scenario.options.rate_hz = rate_hz;
  scenario.options.faults_hz = faults_hz;
  scenario.options.malformed_share = malformed_share;
  scenario.breaks_per_minute = breaks;
  return scenario;
}

}  // namespace

const std::vector<NamedScenario>& NamedScenarios() {
  static const std::vector<NamedScenario> kNamed = {
      {"calm", "everything in its order: nothing wrong, no breaks", Make(10, 0.1, 0, 0)},
      {"rough", "1 % wrong, and each robot breaks off twice a minute", Make(10, 0.1, 0.01, 2)},
      {"storm", "twice as fast, 5 % wrong, and a break every six seconds", Make(20, 0.5, 0.05, 10)},
      {"idle", "one motion message a second and little else", Make(1, 0.02, 0, 0)}};
  return kNamed;
}

absl::StatusOr<Scenario> LoadScenario(const std::string& name_or_path) {
  for (const NamedScenario& named : NamedScenarios()) {
    if (named.name == name_or_path) return named.scenario;
  }
  Scenario scenario;
  try {
    const toml::table table = toml::parse_file(name_or_path);
    for (const auto& [key, node] : table) {
      const absl::Status applied = Apply(name_or_path, std::string(key.str()), node, scenario);
      if (!applied.ok()) return applied;
    }
  } catch (const toml::parse_error& error) {
    return Invalid(fmt::format("{}: neither a scenario's name nor a TOML file: {}", name_or_path,
                               std::string(error.description())));
  }
  return scenario;
}

}  // namespace uplink::synthetic
