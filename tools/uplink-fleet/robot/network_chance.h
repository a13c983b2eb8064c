#pragma once

#include <chrono>
#include <cstdint>
#include <random>
#include <utility>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

/// What the scenario does to a robot's connection.
enum class Mishap : std::uint8_t { kNone, kCut, kBreak, kHalfOpen, kTakeover };

/// What happens in one tick of this phase, by chance. Draws one number, whatever it gives: the same
/// seed gives the same network.
[[nodiscard]] inline Mishap DrawMishap(const Phase& phase, std::mt19937_64& random) {
  using Minutes = std::chrono::duration<double, std::chrono::minutes::period>;
  const double minutes = Minutes(phase.tick()).count();
  double left = std::uniform_real_distribution<double>(0, 1)(random);
  for (const auto& [mishap, per_minute] :
       {std::pair(Mishap::kCut, phase.trouble.cuts_per_minute),
        std::pair(Mishap::kBreak, phase.trouble.breaks_per_minute),
        std::pair(Mishap::kHalfOpen, phase.trouble.half_opens_per_minute),
        std::pair(Mishap::kTakeover, phase.trouble.takeovers_per_minute)}) {
    left -= per_minute * minutes;
    if (left < 0) return mishap;
  }
  return Mishap::kNone;
}

/// What one robot's network does to its connection, tick by tick: one draw per tick, so that the
/// same seed gives the same network however late a tick comes, and storms at their times.
///
/// Thread: confined to one thread.
class NetworkChance final {
 public:
  /// `start` is when the run begins.
  NetworkChance(std::uint64_t seed, SteadyTime start) : random_(seed), start_(start) {}

  /// Draws for a tick that is left out: nothing comes of it.
  void Skip(const Phase& phase) { static_cast<void>(DrawMishap(phase, random_)); }
  /// Draws for a tick; the last mishap that was drawn is kept until Take.
  void Draw(const Phase& phase) {
    if (const Mishap drawn = DrawMishap(phase, random_); drawn != Mishap::kNone) drawn_ = drawn;
  }
  /// What happens now, once: a storm's cut, or what was drawn.
  [[nodiscard]] Mishap Take(const Phase& phase, SteadyTime now) {
    const Mishap drawn = std::exchange(drawn_, Mishap::kNone);
    return Storms(phase, now) ? Mishap::kCut : drawn;
  }
  /// A phase begins: the storms that its own rhythm had before do not come late.
  void Enter(const Phase& phase, SteadyTime now) { static_cast<void>(Storms(phase, now)); }

 private:
  [[nodiscard]] bool Storms(const Phase& phase, SteadyTime now) {
    const milliseconds every = phase.trouble.storm_every;
    if (every.count() == 0) return false;
    const auto storms = (now - start_) / every;
    return std::exchange(storms_, storms) < storms;
  }

  std::mt19937_64 random_;
  const SteadyTime start_;
  std::int64_t storms_ = 0;
  Mishap drawn_ = Mishap::kNone;
};

}  // namespace uplink::synthetic
