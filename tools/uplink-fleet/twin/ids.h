#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::synthetic {

/// Which robot of a twin a message is of.
enum class Side : std::uint8_t { kReal, kSim };
inline constexpr std::size_t kSides = 2;

/// Names a twin and its run. A value.
struct TwinOptions {
  /// The same seed and index give the same twin, which says the same; times and `run` apart.
  std::uint64_t seed = 1;
  std::size_t index = 0;
  /// Tells this run's messages from those of earlier runs.
  std::string run;
  /// Before `cyberwave/` in each topic.
  std::string prefix;
};

/// What a twin and what is around it are called. A value.
/// Source: docs/integrate/cyberwave.md, Robots.
struct TwinIds {
  std::string twin;
  std::string environment;
  std::string workflow_run;
  /// The computer that several drivers of the twin run on.
  std::string computer;
  std::string driver_session;
  std::string sim_session;
  std::string viewer_session;
  std::string ruri;
  std::string sim_ruri;

  [[nodiscard]] const std::string& RuriOf(Side side) const {
    return side == Side::kReal ? ruri : sim_ruri;
  }
};
[[nodiscard]] TwinIds IdsOf(const TwinOptions& options);

/// `~RUN-INDEX-NUMBER~`: stands in each message that must be found again, and nowhere else.
[[nodiscard]] std::string MarkOf(const TwinOptions& options, std::uint64_t number);
/// The number of the first mark of this twin and run among these bytes.
[[nodiscard]] std::optional<std::uint64_t> MarkIn(const TwinOptions& options,
                                                  std::string_view bytes);

}  // namespace uplink::synthetic
