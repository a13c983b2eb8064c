#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// What every robot of a run does. Bounds are those of the flags.
struct ScenarioOptions {
  std::uint64_t seed = 1;
  /// Unique to the run: part of ids and sources, so that rows of other runs are known as such.
  std::string run;
  /// Motion messages per second; one per tick.
  double rate_hz = 10;
  /// Status messages per second.
  double status_hz = 1;
  /// Share of ticks in which something wrong is sent beside the rest.
  double malformed_share = 0;
  /// Fault reports per second, on average.
  double faults_hz = 0.1;
  /// How much faster than the clock a robot lives, but for motion and status: missions, shapes,
  /// objects and the like come as many times as often.
  double pace = 1;
  /// Share of the robots that have an arm, and send RCAN's Robot State once per second.
  double rcan_share = 0.25;
};

/// What happens to a robot's connection. The rates are averages for each robot.
struct Trouble {
  /// The agent ends its stream, and half of the times the connection, in order.
  double breaks_per_minute = 0;
  /// The network forgets the connection: a TCP reset.
  double cuts_per_minute = 0;
  /// Nothing passes any more, and neither side is told.
  double half_opens_per_minute = 0;
  /// A second connection opens while the first one goes on.
  double takeovers_per_minute = 0;
  /// What a robot writes waits so long.
  milliseconds delay{0};
  /// Share of the robots that read nothing for kSlowPause of every kSlowCycle.
  double slow_readers = 0;
  /// Share of a drone's calls whose answer it does not take: it calls again.
  double lost_answers = 0;
  /// All connections are cut in one instant, each time that this has passed; never if 0.
  milliseconds storm_every{0};
};
inline constexpr milliseconds kSlowCycle{4000};
inline constexpr milliseconds kSlowPause{3000};
/// What the server may send ahead of a robot that reads slowly: two or three acks.
inline constexpr std::uint32_t kSlowWindowBytes = 64;

/// Whether the robot of that index is one of this share, spread evenly over the fleet.
[[nodiscard]] inline bool IsOfShare(double share, std::size_t index) {
  const double before = share * static_cast<double>(index);
  return std::floor(before + share) > std::floor(before);
}

/// Whether the robot of that index is one of the slow readers.
[[nodiscard]] inline bool ReadsSlowly(const Trouble& trouble, std::size_t index) {
  return IsOfShare(trouble.slow_readers, index);
}

/// What holds at one time of a scenario.
struct Phase {
  /// Where there are several, which follow each other again and again.
  milliseconds lasts{0};
  /// Seed and run in it are those of the whole run.
  ScenarioOptions options;
  /// Messages that are gathered for a frame.
  std::size_t batch = 1;
  /// Motion is sent as fast as acks let it, whatever the rate.
  bool flood = false;
  Trouble trouble;

  /// From one motion message to the next.
  [[nodiscard]] SteadyTime::duration tick() const {
    return std::chrono::duration_cast<SteadyTime::duration>(
        std::chrono::duration<double>(1 / options.rate_hz));
  }
};

/// A scenario by name or from a file.
struct Scenario {
  /// For people.
  std::string about;
  std::size_t robots = 10;
  /// Robots that connect per second at the start, at most.
  double connects_per_second = 500;
  /// How long each robot lived and kept its messages before it first connects.
  milliseconds offline_before{0};
  /// Share of the robots that decline what the others share.
  double declining_share = 0.1;
  /// Share of the robots that join late, while the others are at work.
  double late_share = 0;
  /// One at least.
  std::vector<Phase> phases = {Phase{}};

  /// The phase that holds so long after the start.
  [[nodiscard]] const Phase& At(milliseconds since_start) const;
};

/// Whether the robot of that index declines what others share.
[[nodiscard]] inline bool Declines(const Scenario& scenario, std::size_t index) {
  return IsOfShare(scenario.declining_share, index);
}
/// Whether it joins late. Half a period of ten from those that decline: the same shares of both
/// are not the same robots.
[[nodiscard]] inline bool JoinsLate(const Scenario& scenario, std::size_t index) {
  return IsOfShare(scenario.late_share, index + 5);
}

/// The names that LoadScenario knows: the files of tests/load/scenarios, built in.
[[nodiscard]] std::vector<std::string> ScenarioNames();

/// The scenario of that name; else the TOML file at that path. Keys at the top hold in every phase
/// that does not name them; what no key sets is as above.
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
inline constexpr ScenarioNumber kConnectsNumber{"connects_per_second", 1, 50'000};
inline constexpr ScenarioNumber kRateNumber{"rate", 0.1, 1000};
inline constexpr ScenarioNumber kStatusNumber{"status", 0.01, 100};
inline constexpr ScenarioNumber kFaultsNumber{"faults", 0, 1000};
inline constexpr ScenarioNumber kMalformedNumber{"malformed_share", 0, 1};
inline constexpr ScenarioNumber kBreaksNumber{"breaks_per_minute", 0, 600};
inline constexpr ScenarioNumber kCutsNumber{"cuts_per_minute", 0, 600};
inline constexpr ScenarioNumber kHalfOpensNumber{"half_opens_per_minute", 0, 60};
inline constexpr ScenarioNumber kTakeoversNumber{"takeovers_per_minute", 0, 600};
inline constexpr ScenarioNumber kSlowReadersNumber{"slow_readers", 0, 1};
inline constexpr ScenarioNumber kLostAnswersNumber{"lost_answers", 0, 0.9};
inline constexpr ScenarioNumber kDecliningNumber{"declining_share", 0, 1};
inline constexpr ScenarioNumber kLateNumber{"late_share", 0, 1};
inline constexpr ScenarioNumber kBatchNumber{"batch", 1, 256};
inline constexpr ScenarioNumber kPaceNumber{"pace", 0.1, 100};
inline constexpr ScenarioNumber kRcanNumber{"rcan_share", 0, 1};
/// Phases of one scenario.
inline constexpr std::size_t kPhasesMax = 32;

}  // namespace uplink::synthetic
