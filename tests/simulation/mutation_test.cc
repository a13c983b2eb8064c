// Each planted fault must be found: a simulation that passes a broken server proves nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/simulation/backends.h"
#include "tests/simulation/planted.h"

namespace uplink::simulation {
namespace {

using robot::Mutation;
using ::testing::HasSubstr;

/// Seeds within which a planted fault must show: the rarest needs a robot that is told its snapshot
/// between a restart of the server and the first read of the shared set.
constexpr std::uint64_t kSeedsMax = 3'000;

RunResult RunSeed(std::uint64_t seed, FakeBackend::Fault fault = FakeBackend::Fault::kNone) {
  const Payloads payloads;
  FakeBackend backend(fault);
  return World(payloads, backend, {.seed = seed, .steps = 400}).Run();
}

/// In a store that never goes back: what is shared there and lost would be told in its place.
RunResult RunSeed(std::uint64_t seed, ForwardFault fault) {
  const Payloads payloads;
  FakeBackend backend;
  return World(
             payloads, backend,
             {.seed = seed, .steps = 400, .forward_fault = fault, .troubles = {.failovers = false}})
      .Run();
}

/// 0 if every seed passes.
template <typename Fault = FakeBackend::Fault>
std::uint64_t FirstFailingSeed(Fault fault = Fault::kNone) {
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    if (!RunSeed(seed, fault).violation.empty()) return seed;
  }
  return 0;
}

class PlantedFault : public ::testing::TestWithParam<Mutation> {
 protected:
  ~PlantedFault() override { robot::Plant(Mutation::kNone); }
};

TEST_P(PlantedFault, IsFound) {
  robot::Plant(GetParam());
  const std::uint64_t seed = FirstFailingSeed();
  ASSERT_NE(seed, 0U);
  RecordProperty("violation", RunSeed(seed).violation);
}

TEST_P(PlantedFault, ReplaysToTheSameViolation) {
  robot::Plant(GetParam());
  const std::uint64_t seed = FirstFailingSeed();
  ASSERT_NE(seed, 0U);
  const RunResult first = RunSeed(seed);
  const RunResult second = RunSeed(seed);
  EXPECT_NE(first.violation, "");
  EXPECT_EQ(first.violation, second.violation);
  EXPECT_EQ(first.steps, second.steps);
  EXPECT_EQ(ToText(first), ToText(second));
}

INSTANTIATE_TEST_SUITE_P(Simulation, PlantedFault,
                         ::testing::Values(Mutation::kAckBeforeCommit, Mutation::kRejectNotRepeated,
                                           Mutation::kSettleLost, Mutation::kDuplicateNotAcked,
                                           Mutation::kPagesNotAwaited, Mutation::kLimitedNotStored,
                                           Mutation::kOfflineForgotten, Mutation::kReconnectTrusted,
                                           Mutation::kSlowFrameUnbounded));

TEST(UnplantedSwitch, ACursorThatMayFallIsFound) {
  EXPECT_NE(FirstFailingSeed(FakeBackend::Fault::kCursorMayFall), 0U);
}

TEST(UnplantedSwitch, ChangesOfPresenceThatNoCursorGuardsAreFound) {
  EXPECT_NE(FirstFailingSeed(FakeBackend::Fault::kNoCursorForPresence), 0U);
}

TEST(UnplantedSwitch, BatchesThatMakeRobotsAreFound) {
  EXPECT_NE(FirstFailingSeed(FakeBackend::Fault::kBatchesMakeRobots), 0U);
}

TEST(UnplantedSwitch, RejectsThatGoForTheirAgeAreFound) {
  EXPECT_NE(FirstFailingSeed(FakeBackend::Fault::kRejectsGoForTheirAge), 0U);
}

TEST(UnplantedSwitch, HoldsThatCountForTheirOwnerWheneverTheyBeganAreFound) {
  EXPECT_NE(FirstFailingSeed(FakeBackend::Fault::kHoldsOfOwnerAlone), 0U);
}

struct ForwardCase {
  ForwardFault fault;
  /// What is said of it.
  const char* violation;
};

class PlantedForwardFault : public ::testing::TestWithParam<ForwardCase> {};

TEST_P(PlantedForwardFault, IsFoundForWhatItIs) {
  const std::uint64_t seed = FirstFailingSeed(GetParam().fault);
  ASSERT_NE(seed, 0U);
  EXPECT_THAT(RunSeed(seed, GetParam().fault).violation, HasSubstr(GetParam().violation));
}

INSTANTIATE_TEST_SUITE_P(
    Simulation, PlantedForwardFault,
    ::testing::Values(ForwardCase{ForwardFault::kBeginsBeforeWhole, "which was there all the time"},
                      ForwardCase{ForwardFault::kHalfSet, "which was there all the time"},
                      ForwardCase{ForwardFault::kPositionAfterItems, "holds"},
                      ForwardCase{ForwardFault::kStaleLook, "holds"},
                      ForwardCase{ForwardFault::kDeleteKept, "holds"},
                      ForwardCase{ForwardFault::kDropsWhenFull, "holds"},
                      ForwardCase{ForwardFault::kOtherFleet, "robot says"},
                      ForwardCase{ForwardFault::kOwnItems, "came back"}));

TEST(UnplantedSwitch, NothingPlantedIsNothingFound) { EXPECT_EQ(FirstFailingSeed(), 0U); }

}  // namespace
}  // namespace uplink::simulation
