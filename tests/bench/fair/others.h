#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tests/bench/fair/other_robot.h"

namespace uplink::bench {

/// The well-behaved robots, whose messages are evenly spread over all of them.
///
/// Errors: a robot that is cut off comes back; what that cost is in the tally.
/// Thread: confined to one thread, which drives all of them.
class Others final {
 public:
  /// Called about every 20 ms while robots are driven; false ends it.
  using OnTurn = std::function<bool()>;

  /// What one robot sends.
  struct Rhythm {
    double messages_per_second = 0;
    /// Live ones before each durable one.
    std::uint64_t live = 0;
  };

  /// `loop` and `clock` outlive it.
  Others(link::Loop& loop, const Clock& clock, link::LinkOptions link, Rhythm rhythm)
      : world_{.loop = loop, .clock = clock, .link = std::move(link)}, rhythm_(rhythm) {}
  /// Closes the connections and lets them end.
  ~Others();
  Others(const Others&) = delete;
  Others& operator=(const Others&) = delete;

  /// Connects a robot for each of the first `robots` identities, some at a time. How many are
  /// welcomed, all of them unless `patience` ran out.
  [[nodiscard]] std::size_t Connect(const std::vector<link::Identity>& identities,
                                    std::size_t robots, milliseconds patience);
  /// Lets them work until `on_turn` ends it; nothing is measured.
  void Drive(const OnTurn& on_turn);
  /// The same, measured. They go on until what was sent in the window is acked, at most
  /// kAckPatience longer.
  [[nodiscard]] OthersTally Measure(const OnTurn& on_turn);
  /// The first robot; there must be one.
  [[nodiscard]] const OtherRobot& first() const { return *robots_.front(); }

  static constexpr milliseconds kAckPatience{5'000};

 private:
  void SendWhatIsDue(SteadyTime now);
  [[nodiscard]] SteadyTime Due() const;
  void Mend();

  OthersWorld world_;
  const Rhythm rhythm_;
  std::vector<std::unique_ptr<OtherRobot>> robots_;
  std::uint64_t windows_ = 0;
  SteadyTime began_{};
  /// Messages since began_, of all robots.
  std::uint64_t sent_ = 0;
  std::size_t next_live_ = 0;
  std::size_t next_event_ = 0;
};

}  // namespace uplink::bench
