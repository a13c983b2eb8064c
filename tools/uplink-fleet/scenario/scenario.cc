#include "tools/uplink-fleet/scenario/scenario.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "server/config/units.h"
#include "tools/uplink-fleet/scenario/scenario_files.h"

namespace uplink::synthetic {
namespace {

/// A key that says what holds at one time, so at the top or in a phase.
struct PhaseKey {
  ScenarioNumber number;
  bool whole;
  void (*set)(Phase& phase, double value);
};

constexpr std::array<PhaseKey, 13> kPhaseKeys = {{
    {kRateNumber, false, [](Phase& to, double value) { to.options.rate_hz = value; }},
    {kStatusNumber, false, [](Phase& to, double value) { to.options.status_hz = value; }},
    {kFaultsNumber, false, [](Phase& to, double value) { to.options.faults_hz = value; }},
    {kMalformedNumber, false, [](Phase& to, double value) { to.options.malformed_share = value; }},
    {kPaceNumber, false, [](Phase& to, double value) { to.options.pace = value; }},
    {kRcanNumber, false, [](Phase& to, double value) { to.options.rcan_share = value; }},
    {kBatchNumber, true,
     [](Phase& to, double value) { to.batch = static_cast<std::size_t>(value); }},
    {kBreaksNumber, false, [](Phase& to, double value) { to.trouble.breaks_per_minute = value; }},
    {kCutsNumber, false, [](Phase& to, double value) { to.trouble.cuts_per_minute = value; }},
    {kHalfOpensNumber, false,
     [](Phase& to, double value) { to.trouble.half_opens_per_minute = value; }},
    {kTakeoversNumber, false,
     [](Phase& to, double value) { to.trouble.takeovers_per_minute = value; }},
    {kLostAnswersNumber, false, [](Phase& to, double value) { to.trouble.lost_answers = value; }},
    {kSlowReadersNumber, false, [](Phase& to, double value) { to.trouble.slow_readers = value; }},
}};

struct PhaseDuration {
  std::string_view key;
  milliseconds max;
  void (*set)(Phase& phase, milliseconds value);
};

constexpr std::array<PhaseDuration, 2> kPhaseDurations = {{
    {"delay", std::chrono::seconds(10),
     [](Phase& to, milliseconds value) { to.trouble.delay = value; }},
    {"storm_every", std::chrono::hours(24),
     [](Phase& to, milliseconds value) { to.trouble.storm_every = value; }},
}};

constexpr milliseconds kOfflineMax = std::chrono::hours(24);
constexpr milliseconds kPhaseMax = std::chrono::hours(24);

absl::Status Invalid(const std::string& text) { return absl::InvalidArgumentError(text); }

/// Reads the nodes of one file.
class FileReader {
 public:
  explicit FileReader(const std::string& path) : path_(path) {}

  absl::StatusOr<Scenario> Read(const toml::table& table) {
    Scenario scenario;
    for (const auto& [key, node] : table) {
      if (key.str() == "phase") continue;
      if (auto status = Top(std::string(key.str()), node, scenario); !status.ok()) return status;
    }
    if (const toml::node* list = table.get("phase")) {
      if (auto status = Phases(*list, scenario); !status.ok()) return status;
    }
    return scenario;
  }

 private:
  absl::Status Top(const std::string& key, const toml::node& node, Scenario& scenario) {
    if (key == "about") {
      scenario.about = node.value_or(std::string());
      return absl::OkStatus();
    }
    if (key == "offline_before") return Take(key, node, kOfflineMax, scenario.offline_before);
    if (key == kRobotsNumber.key) {
      double robots = 0;
      absl::Status status = Take(kRobotsNumber, true, node, robots);
      if (status.ok()) scenario.robots = static_cast<std::size_t>(robots);
      return status;
    }
    if (key == kConnectsNumber.key) {
      return Take(kConnectsNumber, false, node, scenario.connects_per_second);
    }
    if (key == kDecliningNumber.key) {
      return Take(kDecliningNumber, false, node, scenario.declining_share);
    }
    if (key == kLateNumber.key) return Take(kLateNumber, false, node, scenario.late_share);
    return InPhase(key, node, scenario.phases.front());
  }

  absl::Status Phases(const toml::node& list, Scenario& scenario) {
    const toml::array* const phases = list.as_array();
    if (phases == nullptr || phases->empty() || phases->size() > kPhasesMax) {
      return Invalid(fmt::format("{}: phase takes 1 to {} tables", path_, kPhasesMax));
    }
    const Phase common = scenario.phases.front();
    scenario.phases.clear();
    for (const toml::node& each : *phases) {
      const toml::table* const table = each.as_table();
      if (table == nullptr) return Invalid(fmt::format("{}: phase takes tables", path_));
      Phase phase = common;
      for (const auto& [key, node] : *table) {
        const std::string name(key.str());
        absl::Status status =
            name == "for" ? Take(name, node, kPhaseMax, phase.lasts) : InPhase(name, node, phase);
        if (!status.ok()) return status;
      }
      if (phase.lasts.count() <= 0) {
        return Invalid(fmt::format("{}: each phase says with for how long it lasts", path_));
      }
      scenario.phases.push_back(std::move(phase));
    }
    return absl::OkStatus();
  }

  absl::Status InPhase(const std::string& name, const toml::node& node, Phase& phase) {
    if (name == "flood") {
      if (!node.is_boolean()) return Invalid(fmt::format("{}: flood takes true or false", path_));
      phase.flood = node.value_or(false);
      return absl::OkStatus();
    }
    for (const PhaseDuration& key : kPhaseDurations) {
      if (key.key != name) continue;
      milliseconds value{0};
      absl::Status status = Take(name, node, key.max, value);
      if (status.ok()) key.set(phase, value);
      return status;
    }
    const auto* key = std::ranges::find_if(
        kPhaseKeys, [&](const PhaseKey& each) { return each.number.key == name; });
    if (key == kPhaseKeys.end()) return Invalid(fmt::format("{}: no such key: {}", path_, name));
    double value = 0;
    absl::Status status = Take(key->number, key->whole, node, value);
    if (status.ok()) key->set(phase, value);
    return status;
  }

  absl::Status Take(const ScenarioNumber& limits, bool whole, const toml::node& node, double& to) {
    const auto value = node.value<double>();
    if (!value || !(*value >= limits.min && *value <= limits.max) ||
        (whole && *value != std::floor(*value))) {
      return Invalid(fmt::format("{}: {} takes a {}number from {} to {}", path_, limits.key,
                                 whole ? "whole " : "", limits.min, limits.max));
    }
    to = *value;
    return absl::OkStatus();
  }

  absl::Status Take(const std::string& key, const toml::node& node, milliseconds max,
                    milliseconds& to) {
    const auto value = config::ParseDuration(node.value_or(std::string()));
    if (!value || *value > max) {
      return Invalid(fmt::format("{}: {} takes a duration such as \"20s\", up to {}", path_, key,
                                 config::DurationText(max)));
    }
    to = *value;
    return absl::OkStatus();
  }

  const std::string& path_;
};

}  // namespace

const Phase& Scenario::At(milliseconds since_start) const {
  milliseconds all{0};
  for (const Phase& phase : phases) all += phase.lasts;
  if (phases.size() == 1 || all.count() == 0) return phases.front();
  milliseconds left = std::max(since_start, milliseconds(0)) % all;
  for (const Phase& phase : phases) {
    if (left < phase.lasts) return phase;
    left -= phase.lasts;
  }
  return phases.back();
}

std::vector<std::string> ScenarioNames() {
  std::vector<std::string> names;
  names.reserve(ScenarioFiles().size());
  for (const ScenarioFile& file : ScenarioFiles()) names.emplace_back(file.name);
  return names;
}

absl::StatusOr<Scenario> LoadScenario(const std::string& name_or_path) {
  const auto files = ScenarioFiles();
  const auto named = std::ranges::find(files, name_or_path, &ScenarioFile::name);
  try {
    return FileReader(name_or_path)
        .Read(named != files.end() ? toml::parse(named->text) : toml::parse_file(name_or_path));
  } catch (const toml::parse_error& error) {
    return Invalid(fmt::format("{}: neither a scenario's name nor a TOML file: {}", name_or_path,
                               std::string(error.description())));
  }
}

}  // namespace uplink::synthetic
