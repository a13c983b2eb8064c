// As HoldersCanary, with faults that lie in the process itself.
#include <gtest/gtest.h>

#include "tests/simulation/holders_world.h"
#include "tests/simulation/planted.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;

/// Seeds within which a planted fault must show.
constexpr std::uint64_t kSeedsMax = 200;

/// Of kSeedsMax from `first` on; 0 if every seed passes.
std::uint64_t FirstFailingSeed(HoldersOptions::Trouble trouble = HoldersOptions::Trouble::kAll,
                               std::uint64_t first = 1) {
  for (std::uint64_t seed = first; seed < first + kSeedsMax; ++seed) {
    if (!HoldersWorld({.seed = seed, .trouble = trouble}).Run().violation.empty()) return seed;
  }
  return 0;
}

TEST(HoldersMutation, AFencedProcessThatForgetsNothingIsFound) {
  robot::Plant(Mutation::kFenceKeepsState);
  const std::uint64_t seed = FirstFailingSeed();
  robot::Plant(Mutation::kNone);
  EXPECT_NE(seed, 0U);
}

TEST(HoldersMutation, AnOfflineThatAFailoverPutBackIsFound) {
  // One seed in about a thousand shows it.
  constexpr std::uint64_t kFirst = 1'000;
  robot::Plant(Mutation::kOfflineUndoubted);
  const std::uint64_t seed = FirstFailingSeed(HoldersOptions::Trouble::kFailovers, kFirst);
  robot::Plant(Mutation::kNone);
  EXPECT_NE(seed, 0U);
}

}  // namespace
}  // namespace uplink::simulation
