#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

namespace uplink::synthetic {

/// What every robot of a run does. Bounds are those of the flags.
struct ScenarioOptions {
  std::uint64_t seed = 1;
  /// Unique to the run: part of ids and sources, so that rows of other runs are known as such.
  std::string run;
  /// Motion messages a second; a tick each.
  double rate_hz = 10;
  /// Share of ticks in which something wrong is sent beside the rest.
  double malformed_share = 0;
  /// Fault reports a second, on average.
  double faults_hz = 0.1;
  /// How much faster than the clock a robot lives, but for motion and status: missions, shapes,
  /// objects and the like come as many times as often.
  double pace = 1;
};

/// A scenario by name or from a file: what the flags of the same names would say.
struct Scenario {
  std::size_t robots = 10;
  /// Messages that are gathered for a frame.
  std::size_t batch = 1;
  double breaks_per_minute = 0;
  ScenarioOptions options;
};

/// The names that LoadScenario knows, with what they are for.
struct NamedScenario {
  std::string_view name;
  std::string_view text;
  Scenario scenario;
};
[[nodiscard]] const std::vector<NamedScenario>& NamedScenarios();

/// The scenario of that name; else the TOML file at that path, whose keys are robots, rate, faults,
/// malformed_share, breaks_per_minute, batch and pace; those that it leaves out are as in `calm`.
///
/// Errors: kInvalidArgument for a file that cannot be read, an unknown key or a value out of range,
///         which is named with its limits.
[[nodiscard]] absl::StatusOr<Scenario> LoadScenario(const std::string& name_or_path);

/// A number of a scenario and its limits, for flags and files alike.
struct ScenarioNumber {
  std::string_view key;
  double min = 0;
  double max = 0;
};
inline constexpr ScenarioNumber kRobotsNumber{"robots", 1, 50'000};
inline constexpr ScenarioNumber kRateNumber{"rate", 0.1, 1000};
inline constexpr ScenarioNumber kFaultsNumber{"faults", 0, 1000};
inline constexpr ScenarioNumber kMalformedNumber{"malformed_share", 0, 1};
inline constexpr ScenarioNumber kBreaksNumber{"breaks_per_minute", 0, 600};
inline constexpr ScenarioNumber kBatchNumber{"batch", 1, 256};
inline constexpr ScenarioNumber kPaceNumber{"pace", 0.1, 100};

}  // namespace uplink::synthetic
