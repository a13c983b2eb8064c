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

/// A robot is heavy if it stores over so many times the median of all robots that store anything.
inline constexpr std::uint64_t kHeavyTimes = 4;
/// The least that a heavy robot may store, in bytes per second: about one event.
inline constexpr std::uint64_t kHeavyRateMin = 256;

/// How much each robot stored within about the last hour, and which store far more than the others.
///
/// Older bytes count less: after an hour 37 %. So each robot takes a few words of memory, however
/// often it is sampled.
///
/// Limits:  one entry per robot of the fleet; none of a robot that left memory.
/// Thread:  confined to one at a time.
class HeavyWriters final {
 public:
  struct Writer {
    std::string ruri;
    std::uint64_t bytes_per_hour = 0;
  };

  /// Adds what each robot has stored since the last call. `passed` is the part of the time since
  /// then in which robots could store.
  void Sample(std::span<const RobotPtr> robots, milliseconds passed);
  /// Bytes per hour of the median robot among those that stored anything within the last hour, the
  /// lower one of two in the middle. 0 if there are none.
  [[nodiscard]] std::uint64_t median() const { return PerHour(median_hour_bytes_); }
  /// What a heavy robot may store, in bytes per second: the median, at least kHeavyRateMin.
  [[nodiscard]] std::uint64_t rate() const;

  /// The robots that stored most within the last hour, the heaviest first, at most `count`.
  [[nodiscard]] std::vector<Writer> Heaviest(std::size_t count) const;
  /// Names, until Release, robots that are heavy now and store more than rate() allows. Returns
  /// those that were not named before, the heaviest first.
  std::vector<Writer> Name();
  /// No robot is named any more.
  void Release();
  [[nodiscard]] bool IsNamed(const robot::Robot& robot) const;
  /// How many are named.
  [[nodiscard]] std::size_t named() const { return named_; }

 private:
  struct Entry {
    /// It also keeps the robot's address from being used for another.
    std::weak_ptr<robot::Robot> robot;
    /// DurableFlow::bytes_total at the last look.
    std::uint64_t bytes_total = 0;
    double hour_bytes = 0;
    /// time_ when it last had stored something.
    milliseconds stored_at{0};
    std::uint32_t look = 0;
    bool named = false;
  };
  void FindMedian();
  /// Scaled to a whole hour, while sampling has lasted less.
  [[nodiscard]] std::uint64_t PerHour(double hour_bytes) const;
  [[nodiscard]] bool StoresAnything(const Entry& entry) const;

  std::unordered_map<const robot::Robot*, Entry> entries_;
  /// The sum of `passed`.
  milliseconds time_{0};
  std::uint32_t look_ = 0;
  double median_hour_bytes_ = 0;
  std::size_t named_ = 0;
};

}  // namespace uplink::fleet
