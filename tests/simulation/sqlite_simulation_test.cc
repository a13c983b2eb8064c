#include <gtest/gtest.h>

#include "tests/simulation/sqlite_backend.h"

namespace uplink::simulation {
namespace {

constexpr std::uint64_t kSeeds = 150;

TEST(Simulation, KeepsEveryPromiseOnSqlite) {
  const Payloads payloads;
  std::uint64_t replacements = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SqliteBackend backend;
    World world(payloads, backend, {.seed = seed, .steps = 400});
    const RunResult result = world.Run();
    ASSERT_EQ(result.violation, "");
    replacements += result.replacements;
  }
  EXPECT_GT(replacements, kSeeds / 20);
}

}  // namespace
}  // namespace uplink::simulation
