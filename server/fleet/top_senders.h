#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/robot/traffic.h"

namespace uplink::fleet {

/// How often the robots' counts are looked at.
inline constexpr std::chrono::seconds kTopEvery{5};
/// A look within this time after the last one changes nothing.
inline constexpr std::chrono::seconds kTopApart{1};
/// The rates are those of about so long: what was sent so long ago counts 37 %.
inline constexpr std::chrono::seconds kTopWindow{60};
/// Robots that one answer names at most.
inline constexpr std::size_t kTopMax = 100;

/// By what robots are compared.
enum class TopBy : std::uint8_t { kMessages, kBytes, kRows };
inline constexpr std::array<std::string_view, 3> kTopByNames = {"messages", "bytes", "rows"};

/// How much each robot sends to this process now, and which send most.
///
/// Limits:  one entry per robot of the fleet; none of a robot that left memory.
/// Thread:  thread-safe.
class TopSenders final {
 public:
  struct Sender {
    std::string ruri;
    std::string fleet;
    double per_second = 0;
  };

  /// Both outlive it.
  TopSenders(const Clock& clock, const Fleet& fleet) : clock_(clock), fleet_(fleet) {}
  TopSenders(const TopSenders&) = delete;
  TopSenders& operator=(const TopSenders&) = delete;

  /// Adds what each robot has sent since the last look. Call it every kTopEvery.
  void Look();
  /// The robots that send most, at most `count`, after one more look. Only robots of these fleets;
  /// none: of any. None that sends nothing.
  [[nodiscard]] std::vector<Sender> Most(TopBy by, std::size_t count,
                                         std::span<const std::string> fleets = {});

 private:
  using Rates = std::array<double, kTopByNames.size()>;
  struct Entry {
    /// It also keeps the robot's address from being used for another.
    std::weak_ptr<robot::Robot> robot;
    std::array<std::uint64_t, kTopByNames.size()> totals{};
    /// What was sent, less what faded.
    Rates sent{};
    std::uint64_t look = 0;
  };
  struct Rated {
    double per_second = 0;
    RobotPtr robot;
  };
  /// All that send anything.
  [[nodiscard]] std::vector<Rated> RatedBy(TopBy by);
  /// Under the lock: the rate of what was sent within the window, or within the shorter time since
  /// the start.
  [[nodiscard]] double PerSecond(double sent) const;

  const Clock& clock_;
  const Fleet& fleet_;
  std::mutex mutex_;
  std::unordered_map<const robot::Robot*, Entry> entries_;
  std::uint64_t look_ = 0;
  std::optional<SteadyTime> looked_at_;
  /// The sum of the times between looks.
  std::chrono::duration<double> looked_for_{0};
};

/// `messages` and so on, or nothing.
[[nodiscard]] std::optional<TopBy> TopByFromText(std::string_view text);

}  // namespace uplink::fleet
