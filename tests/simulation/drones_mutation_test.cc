// Each planted fault must be found: a simulation that passes a broken server proves nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/simulation/drones_world.h"
#include "tests/simulation/planted.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;
using ::testing::HasSubstr;
using Fault = FakeDronesBackend::Fault;

/// Seeds within which a planted fault must show.
constexpr std::uint64_t kSeedsMax = 300;

/// The first violation; empty if every seed passes.
std::string FirstViolation(Fault fault = Fault::kNone) {
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    FakeDronesBackend backend(fault);
    const DronesResult result = DronesWorld(backend, {.seed = seed}).Run();
    if (!result.violation.empty()) return result.violation;
  }
  return {};
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
  EXPECT_THAT(FirstViolation(), HasSubstr(GetParam().violation));
}

INSTANTIATE_TEST_SUITE_P(
    Simulation, PlantedDroneFault,
    ::testing::Values(Case{Mutation::kSampleAnsweredEarly, "the store has it not"},
                      Case{Mutation::kFencedSampleAnswered, "the store has it not"},
                      Case{Mutation::kClaimMemoryForgotten, "and the last change was to"}));

TEST(PlantedStoreFault, ASampleThatIsTakenTwiceAfterARestartIsFound) {
  EXPECT_THAT(FirstViolation(Fault::kSamplesForgotten), HasSubstr("is stored twice"));
}

TEST(PlantedStoreFault, AClaimWhoseEpochIsNotComparedIsFound) {
  EXPECT_THAT(FirstViolation(Fault::kClaimsNotCompared), HasSubstr("which is over"));
}

TEST(PlantedStoreFault, NothingPlantedIsNothingFound) { EXPECT_EQ(FirstViolation(), ""); }

}  // namespace
}  // namespace uplink::simulation
