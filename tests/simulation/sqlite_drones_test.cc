// Drones that call a server on the SQLite store, which restarts (DronesWorld).
#include <string>

#include <gtest/gtest.h>

#include "tests/simulation/drones_sqlite.h"
#include "tests/simulation/drones_world.h"

namespace uplink::simulation {
namespace {

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
  EXPECT_GT(stored, kSeeds * 8);
}

TEST(DronesOnSqlite, ASampleThatIsTakenTwiceAfterARestartIsFound) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::string violation = RunSeed(seed, Fault::kSamplesForgotten).violation;
    if (violation.find("is stored twice") != std::string::npos) return;
  }
  FAIL() << "no seed finds it";
}

}  // namespace
}  // namespace uplink::simulation
