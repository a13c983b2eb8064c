#include "tools/uplink-fleet/robot/network_chance.h"

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using std::chrono::seconds;

constexpr SteadyTime kStart{seconds(100)};

Phase WithCuts() {
  Phase phase;
  phase.trouble.cuts_per_minute = 300;
  return phase;
}

TEST(NetworkChance, GivesAMishapOnce) {
  Phase always;
  always.options.rate_hz = 0.1;
  always.trouble.cuts_per_minute = 600;
  NetworkChance network(1, kStart);
  network.Draw(always);
  EXPECT_EQ(network.Take(always, kStart), Mishap::kCut);
  EXPECT_EQ(network.Take(always, kStart), Mishap::kNone);
}

TEST(NetworkChance, GivesTheSameNetworkWhenTicksAreLeftOut) {
  const Phase phase = WithCuts();
  NetworkChance whole(7, kStart);
  NetworkChance with_a_hole(7, kStart);
  for (int tick = 0; tick < 200; ++tick) {
    const SteadyTime now = kStart + tick * phase.tick();
    whole.Draw(phase);
    const Mishap drawn = whole.Take(phase, now);
    if (tick < 50) {
      with_a_hole.Skip(phase);
      EXPECT_EQ(with_a_hole.Take(phase, now), Mishap::kNone);
      continue;
    }
    with_a_hole.Draw(phase);
    EXPECT_EQ(with_a_hole.Take(phase, now), drawn) << tick;
  }
}

TEST(NetworkChance, CutsOncePerStorm) {
  Phase stormy;
  stormy.trouble.storm_every = seconds(10);
  NetworkChance network(1, kStart);
  EXPECT_EQ(network.Take(stormy, kStart + seconds(9)), Mishap::kNone);
  EXPECT_EQ(network.Take(stormy, kStart + seconds(10)), Mishap::kCut);
  EXPECT_EQ(network.Take(stormy, kStart + seconds(11)), Mishap::kNone);
  EXPECT_EQ(network.Take(stormy, kStart + seconds(35)), Mishap::kCut);
}

TEST(NetworkChance, LeavesOutStormsFromBeforeAPhase) {
  Phase stormy;
  stormy.trouble.storm_every = seconds(10);
  NetworkChance network(1, kStart);
  network.Enter(stormy, kStart + seconds(25));
  EXPECT_EQ(network.Take(stormy, kStart + seconds(26)), Mishap::kNone);
  EXPECT_EQ(network.Take(stormy, kStart + seconds(30)), Mishap::kCut);
}

constexpr int kTicks = 600'000;

std::vector<Mishap> Draw(const Phase& phase, std::uint64_t seed, int ticks) {
  std::mt19937_64 random(seed);
  std::vector<Mishap> drawn;
  drawn.reserve(static_cast<std::size_t>(ticks));
  for (int i = 0; i < ticks; ++i) drawn.push_back(DrawMishap(phase, random));
  return drawn;
}

Phase Troubled() {
  Phase phase;
  phase.trouble.cuts_per_minute = 6;
  phase.trouble.breaks_per_minute = 3;
  phase.trouble.half_opens_per_minute = 1.5;
  phase.trouble.takeovers_per_minute = 12;
  return phase;
}

TEST(MishapTest, TheSameSeedGivesTheSameNetwork) {
  EXPECT_EQ(Draw(Troubled(), 7, 10'000), Draw(Troubled(), 7, 10'000));
  EXPECT_NE(Draw(Troubled(), 7, 10'000), Draw(Troubled(), 8, 10'000));
}

TEST(MishapTest, ItsRatesAreThoseOfThePhaseWhateverTheTick) {
  for (const double rate : {10.0, 600.0}) {
    Phase phase = Troubled();
    phase.options.rate_hz = rate;
    std::array<double, 5> counts{};
    for (const Mishap mishap : Draw(phase, 1, kTicks)) ++counts[static_cast<std::size_t>(mishap)];
    const double minutes = kTicks / rate / 60;
    // Counts of rare chances: within five deviations of what they are on average.
    const auto near = [&](Mishap mishap, double per_minute) {
      const double average = per_minute * minutes;
      EXPECT_NEAR(counts[static_cast<std::size_t>(mishap)], average, 5 * std::sqrt(average))
          << rate << " ticks a second";
    };
    near(Mishap::kCut, phase.trouble.cuts_per_minute);
    near(Mishap::kBreak, phase.trouble.breaks_per_minute);
    near(Mishap::kHalfOpen, phase.trouble.half_opens_per_minute);
    near(Mishap::kTakeover, phase.trouble.takeovers_per_minute);
  }
}

TEST(MishapTest, NothingHappensInAGoodNetwork) {
  for (const Mishap mishap : Draw(Phase(), 1, 1000)) EXPECT_EQ(mishap, Mishap::kNone);
}

}  // namespace
}  // namespace uplink::synthetic
