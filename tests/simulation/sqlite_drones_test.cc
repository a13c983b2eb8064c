// Drones that call a server on the SQLite store, which restarts (DronesWorld).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/simulation/drones_sqlite.h"
#include "tests/simulation/drones_world.h"

namespace uplink::simulation {
namespace {

using ::testing::HasSubstr;
using Fault = SqliteDronesBackend::Fault;

constexpr std::uint64_t kSeeds = 60;

DronesResult RunSeed(std::uint64_t seed, Fault fault = Fault::kNone) {
  SqliteDronesBackend backend(fault);
  return DronesWorld(backend, {.seed = seed}).Run();
}

TEST(DronesOnSqlite, AnswersAreTrueAndEachSampleIsStoredOnce) {
  std::uint64_t stored = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    DronesResult result = RunSeed(seed);
    ASSERT_EQ(result.violation, "");
    stored += result.ends["STORED"];
  }
  EXPECT_GT(stored, kSeeds * 10);
}

TEST(DronesOnSqlite, ASampleThatIsTakenTwiceAfterARestartIsFound) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const DronesResult result = RunSeed(seed, Fault::kSamplesForgotten);
    if (result.violation.empty()) continue;
    EXPECT_THAT(result.violation, HasSubstr("is stored twice"));
    return;
  }
  FAIL() << "no seed finds it";
}

}  // namespace
}  // namespace uplink::simulation
