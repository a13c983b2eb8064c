#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "tests/bench/fair/other_robot.h"

namespace uplink::bench {

/// The well-behaved robots: each sends a live message per second and an event every two seconds,
/// evenly spread over all of them.
///
/// Errors: a robot that is cut off comes back; what that cost is in the tally.
/// Thread: confined to one thread, which drives all of them.
class Others final {
 public:
  /// Called about every 100 ms while robots are driven; false ends it early.
  using OnTurn = std::function<bool()>;

  /// `loop` and `clock` outlive it.
  Others(link::Loop& loop, const Clock& clock, link::LinkOptions link)
      : world_{.loop = loop, .clock = clock, .link = std::move(link)} {}
  /// Closes the connections and lets them end.
  ~Others();
  Others(const Others&) = delete;
  Others& operator=(const Others&) = delete;

  /// Connects a robot for each of the first `robots` identities, some at a time. How many are
  /// welcomed, all of them unless `patience` ran out.
  [[nodiscard]] std::size_t Connect(const std::vector<link::Identity>& identities,
                                    std::size_t robots, milliseconds patience);
  /// Lets them work for so long; nothing is measured. False if `on_turn` ended it.
  bool Drive(milliseconds duration, const OnTurn& on_turn);
  /// The same, measured. They go on until what was sent in the window is acked, at most
  /// kAckPatience longer.
  [[nodiscard]] OthersTally Measure(milliseconds duration, const OnTurn& on_turn);

  static constexpr milliseconds kAckPatience{5'000};

 private:
  void SendWhatIsDue(SteadyTime now);
  [[nodiscard]] SteadyTime Due() const;
  [[nodiscard]] bool HasPending(std::uint64_t window) const;
  [[nodiscard]] std::size_t CountOpen() const;

  OthersWorld world_;
  std::vector<std::unique_ptr<OtherRobot>> robots_;
  std::uint64_t windows_ = 0;
  SteadyTime began_{};
  /// Messages since began_, of all robots.
  std::uint64_t sent_ = 0;
  std::size_t next_live_ = 0;
  std::size_t next_event_ = 0;
};

/// The value below which so much of them lies (`share` of 0.99: the 99th percentile); 0 of none.
[[nodiscard]] double Quantile(std::vector<double> values, double share);

}  // namespace uplink::bench
