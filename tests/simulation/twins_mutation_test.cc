// Each planted fault must be found: a simulation that passes a broken server proves nothing.
#include <gtest/gtest.h>

#include "tests/simulation/planted.h"
#include "tests/simulation/twins_world.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;

/// Seeds within which a planted fault must show.
constexpr std::uint64_t kSeedsMax = 300;

class PlantedTwinFault : public ::testing::TestWithParam<Mutation> {
 protected:
  static Failovers FailoversFor(Mutation mutation) {
    return mutation == Mutation::kSettledAckedFromMemory ? Failovers::kYes : Failovers::kNo;
  }
  ~PlantedTwinFault() override { robot::Plant(Mutation::kNone); }
};

TEST_P(PlantedTwinFault, IsFound) {
  robot::Plant(GetParam());
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    const TwinsResult result = TwinsWorld(seed, FailoversFor(GetParam())).Run();
    if (result.violation.empty()) continue;
    RecordProperty("violation", result.violation);
    return;
  }
  FAIL() << "no seed finds it";
}

INSTANTIATE_TEST_SUITE_P(Simulation, PlantedTwinFault,
                         ::testing::Values(Mutation::kMessageAckedOnArrival,
                                           Mutation::kRedeliveryForgotten,
                                           Mutation::kSettledAckedFromMemory));

}  // namespace
}  // namespace uplink::simulation
