#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"

namespace uplink::fleet {

/// A robot that stores over so many times the median of all that store anything is heavy.
inline constexpr std::uint64_t kHeavyTimes = 4;
/// What a heavy robot may store at least, in bytes per second: about one event.
inline constexpr std::uint64_t kHeavyRateMin = 256;

/// What each robot stored within about the last hour, and who stores far more than the others.
///
/// What was stored counts the less the longer ago it was: after an hour 37 %. So a robot takes a
/// few words, however often it is looked at.
///
/// Limits:  one entry per robot of the fleet; none of a robot that left memory.
/// Thread:  confined to one at a time.
class HeavyWriters final {
 public:
  struct Writer {
    std::string ruri;
    std::uint64_t bytes_per_hour = 0;
  };

  /// Looks at what each robot has stored since the last call. `passed` is the time since then in
  /// which robots could store something.
  void Sample(std::span<const RobotPtr> robots, milliseconds passed);
  /// Bytes per hour of the median of the robots that stored anything within the last hour; of two
  /// in the middle the lower one. 0 if there are none.
  [[nodiscard]] std::uint64_t median() const { return PerHour(median_hour_bytes_); }
  /// What a heavy robot may store, in bytes per second: as much as the median, and never nothing.
  [[nodiscard]] std::uint64_t rate() const;

  /// Those that stored most of what was stored within the last hour, the heaviest first, `count` at
  /// most.
  [[nodiscard]] std::vector<Writer> Heaviest(std::size_t count) const;
  /// Names those that are heavy now, and more than rate() allows, until Release. Returns those that
  /// were not named before, the heaviest first.
  std::vector<Writer> Name();
  /// Nobody is named any more.
  void Release();
  [[nodiscard]] bool IsNamed(const robot::Robot& robot) const;
  /// How many are named.
  [[nodiscard]] std::size_t named() const { return named_; }

 private:
  struct Entry {
    /// Also keeps the robot's address from being another's.
    std::weak_ptr<robot::Robot> robot;
    /// DurableFlow::bytes_total at the last look.
    std::uint64_t bytes_total = 0;
    double hour_bytes = 0;
    /// As time_ was when it had stored something.
    milliseconds stored_at{0};
    std::uint32_t look = 0;
    bool named = false;
  };
  void FindMedian();
  /// Bytes of a whole hour, though this may have looked for less.
  [[nodiscard]] std::uint64_t PerHour(double hour_bytes) const;
  [[nodiscard]] bool StoresAnything(const Entry& entry) const;

  std::unordered_map<const robot::Robot*, Entry> entries_;
  /// All that passed.
  milliseconds time_{0};
  std::uint32_t look_ = 0;
  double median_hour_bytes_ = 0;
  std::size_t named_ = 0;
};

}  // namespace uplink::fleet
