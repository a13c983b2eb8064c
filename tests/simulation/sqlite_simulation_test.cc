#include <gtest/gtest.h>

#include "tests/simulation/sqlite_backend.h"

namespace uplink::simulation {
namespace {

constexpr std::uint64_t kSeeds = 150;

TEST(Simulation, KeepsEveryPromiseOnSqlite) {
  const Payloads payloads;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SqliteBackend backend;
    World world(payloads, backend, {.seed = seed, .steps = 400});
    ASSERT_EQ(world.Run().violation, "");
  }
}

}  // namespace
}  // namespace uplink::simulation
