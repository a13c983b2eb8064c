#include "tools/uplink-fleet/robot/network_chance.h"

#include <chrono>
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

}  // namespace
}  // namespace uplink::synthetic
