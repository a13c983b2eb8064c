// Twins behind a broker (TwinsWorld).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulation/twins_world.h"

namespace uplink::simulation {
namespace {

constexpr std::uint64_t kSeeds = 300;
constexpr Failovers kFailovers = Failovers::kYes;

TEST(Twins, APubackMeansStoredAndEachMessageIsStoredOnce) {
  TwinsResult sum;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TwinsResult result = TwinsWorld(seed, kFailovers).Run();
    ASSERT_EQ(result.violation, "");
    sum.published += result.published;
    sum.acked += result.acked;
    sum.redelivered += result.redelivered;
    sum.kills += result.kills;
    sum.failovers += result.failovers;
  }
  EXPECT_GT(sum.acked, kSeeds * 30);
  EXPECT_GT(sum.redelivered, kSeeds * 5);
  EXPECT_GT(sum.kills, kSeeds / 2);
  fmt::print("{} seeds: {} published, {} acked, {} redelivered, {} kills, {} failovers\n", kSeeds,
             sum.published, sum.acked, sum.redelivered, sum.kills, sum.failovers);
}

TEST(Twins, ReplaysASeedToTheSameEnd) {
  const auto run = [] { return TwinsWorld(7, kFailovers).Run(); };
  const TwinsResult first = run();
  const TwinsResult second = run();
  EXPECT_GT(first.acked, 0U);
  EXPECT_EQ(first.acked, second.acked);
  EXPECT_EQ(first.redelivered, second.redelivered);
}

}  // namespace
}  // namespace uplink::simulation
