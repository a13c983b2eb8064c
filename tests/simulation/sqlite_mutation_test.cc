// As mutation_test.cc: a store that goes on with its open files though others took their names.
#include <gtest/gtest.h>

#include "tests/simulation/sqlite_backend.h"

namespace uplink::simulation {
namespace {

/// Seeds within which it must show.
constexpr std::uint64_t kSeedsMax = 150;

TEST(UnnamedFiles, AreFound) {
  const Payloads payloads;
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    SqliteBackend backend;
    const RunResult result = World(payloads, backend, {.seed = seed, .steps = 400}).Run();
    if (result.violation.empty()) continue;
    RecordProperty("violation", result.violation);
    EXPECT_GT(result.replacements, 0U) << result.violation;
    return;
  }
  FAIL() << "no seed finds it";
}

}  // namespace
}  // namespace uplink::simulation
