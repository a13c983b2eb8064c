// Each planted fault must be found: a simulation that passes a broken server proves nothing.
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/simulation/drones_world.h"
#include "tests/simulation/planted.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;
using Fault = FakeDronesBackend::Fault;

/// Seeds within which a planted fault must show.
constexpr std::uint64_t kSeedsMax = 300;

std::string RunSeed(std::uint64_t seed, Fault fault = Fault::kNone) {
  FakeDronesBackend backend(fault);
  return DronesWorld(backend, {.seed = seed}).Run().violation;
}

/// Whether some seed breaks a promise, and says this of it.
bool IsFound(std::string_view what, Fault fault = Fault::kNone) {
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    if (RunSeed(seed, fault).find(what) != std::string::npos) return true;
  }
  return false;
}

struct Case {
  Mutation mutation;
  /// What is said of it.
  const char* violation;
};

class PlantedDroneFault : public ::testing::TestWithParam<Case> {
 protected:
  ~PlantedDroneFault() override { robot::Plant(Mutation::kNone); }
};

TEST_P(PlantedDroneFault, IsFoundForWhatItIs) {
  robot::Plant(GetParam().mutation);
  EXPECT_TRUE(IsFound(GetParam().violation));
}

INSTANTIATE_TEST_SUITE_P(
    Simulation, PlantedDroneFault,
    ::testing::Values(Case{Mutation::kSampleAnsweredEarly, "the store has it not"},
                      Case{Mutation::kFencedSampleAnswered, "the store has it not"},
                      Case{Mutation::kClaimMemoryForgotten, "and the last change was to"}));

TEST(PlantedStoreFault, ASampleThatIsTakenTwiceAfterARestartIsFound) {
  EXPECT_TRUE(IsFound("is stored twice", Fault::kSamplesForgotten));
}

TEST(PlantedStoreFault, AClaimWhoseEpochIsNotComparedIsFound) {
  EXPECT_TRUE(IsFound("which is over", Fault::kClaimsNotCompared));
}

TEST(PlantedStoreFault, NothingPlantedIsNothingFound) {
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) ASSERT_EQ(RunSeed(seed), "");
}

}  // namespace
}  // namespace uplink::simulation
