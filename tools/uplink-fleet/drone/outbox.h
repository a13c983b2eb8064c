#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/drone/call.h"
#include "tools/uplink-fleet/robot/backoff.h"

namespace uplink::synthetic {

/// A drone's calls until each is answered. Of a line one is on its way at a time; what was not
/// answered is sent again after a pause, unless it is live and a newer one has come.
///
/// Limits: a live line has one call that waits, since a newer one takes its place; for the others
///         the caller of Add asks IsBusy first.
/// Thread: confined to one thread.
class DroneOutbox final {
 public:
  DroneOutbox(std::size_t lines, std::uint64_t seed) : lines_(lines, Line(seed)) {}

  void Add(AvatarCall call, SteadyTime now);

  /// A call that leaves now.
  struct Leaving {
    AvatarCall call;
    /// Since when it was to be answered.
    SteadyTime due;
    /// 1: it leaves for the first time.
    std::size_t tries = 1;
  };
  [[nodiscard]] std::optional<Leaving> Next(SteadyTime now);
  // What became of the call of that line which is on its way.
  void Answered(std::size_t line);
  void Lost(std::size_t line, SteadyTime now);

  [[nodiscard]] bool IsBusy(std::size_t line) const { return !lines_.at(line).calls.empty(); }
  [[nodiscard]] bool empty() const;

 private:
  struct Waiting {
    AvatarCall call;
    SteadyTime due;
    std::size_t tries = 0;
  };
  struct Line {
    explicit Line(std::uint64_t seed) : backoff(seed) {}
    /// The first is on its way if `away`.
    std::deque<Waiting> calls;
    bool away = false;
    SteadyTime again_at{};
    Backoff backoff;
  };

  std::vector<Line> lines_;
};

}  // namespace uplink::synthetic
