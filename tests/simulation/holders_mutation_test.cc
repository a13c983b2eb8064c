// As HoldersCanary, with faults that lie in the process itself.
#include <gtest/gtest.h>

#include "tests/simulation/holders_world.h"
#include "tests/simulation/planted.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;

/// Seeds within which a planted fault must show.
constexpr std::uint64_t kSeedsMax = 200;

/// 0 if every seed passes.
std::uint64_t FirstFailingSeed() {
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    if (!HoldersWorld({.seed = seed}).Run().violation.empty()) return seed;
  }
  return 0;
}

TEST(HoldersMutation, AFencedProcessThatForgetsNothingIsFound) {
  robot::Plant(Mutation::kFenceKeepsState);
  const std::uint64_t seed = FirstFailingSeed();
  robot::Plant(Mutation::kNone);
  EXPECT_NE(seed, 0U);
}

}  // namespace
}  // namespace uplink::simulation
