// Presence with two or three server processes on one store (HoldersWorld).
#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulation/holders_world.h"

namespace uplink::simulation {
namespace {

using Trouble = HoldersOptions::Trouble;

/// Lines of a failed run that are shown.
constexpr std::size_t kLinesShown = 80;

std::string TextOf(std::uint64_t seed, const HoldersResult& result) {
  std::string text = fmt::format("seed {}: {}\n", seed, result.violation);
  const std::size_t lines = result.lines.size();
  for (std::size_t i = lines - std::min(lines, kLinesShown); i < lines; ++i) {
    text += result.lines[i] + "\n";
  }
  return text;
}

/// Runs seeds from 1 on; the results are summed up.
HoldersResult RunSeeds(std::uint64_t seeds, Trouble trouble) {
  HoldersResult sum;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const HoldersResult result = HoldersWorld({.seed = seed, .trouble = trouble}).Run();
    EXPECT_EQ(result.violation, "") << TextOf(seed, result);
    if (::testing::Test::HasFailure()) return sum;
    sum.rows += result.rows;
    sum.adoptions += result.adoptions;
    sum.moves += result.moves;
    sum.moves_to_cut += result.moves_to_cut;
    sum.half_open += result.half_open;
    sum.long_standstills += result.long_standstills;
    sum.kills += result.kills;
    sum.standstills += result.standstills;
    sum.cuts += result.cuts;
    sum.stops += result.stops;
    sum.deletions += result.deletions;
    sum.suspends += result.suspends;
    sum.failovers += result.failovers;
    sum.session_ends += result.session_ends;
  }
  return sum;
}

TEST(Holders, EachTrueChangeIsOneRowWhileNothingFails) {
  constexpr std::uint64_t kSeeds = 60;
  const HoldersResult sum = RunSeeds(kSeeds, Trouble::kNone);
  EXPECT_GT(sum.moves, kSeeds * 5);
  EXPECT_GT(sum.rows, kSeeds * 10);
}

TEST(Holders, RollingUpdatesChangeNobodysPresence) {
  constexpr std::uint64_t kSeeds = 60;
  const HoldersResult sum = RunSeeds(kSeeds, Trouble::kUpdates);
  EXPECT_GT(sum.stops, kSeeds * 2);
}

TEST(Holders, NobodyIsFalselyOfflineAndEverythingSettlesAfterAnyTrouble) {
  constexpr std::uint64_t kSeeds = 400;
  const HoldersResult sum = RunSeeds(kSeeds, Trouble::kAll);
  EXPECT_GT(sum.kills, kSeeds);
  EXPECT_GT(sum.standstills, kSeeds);
  EXPECT_GT(sum.cuts, kSeeds);
  EXPECT_GT(sum.adoptions, kSeeds);
  EXPECT_GT(sum.moves_to_cut, kSeeds);
  EXPECT_GT(sum.half_open, kSeeds);
  EXPECT_GT(sum.long_standstills, kSeeds / 2);
  fmt::print(
      "{} seeds: {} rows, {} adoptions, {} moves; {} kills, {} standstills, {} cuts, {} stops\n",
      kSeeds, sum.rows, sum.adoptions, sum.moves, sum.kills, sum.standstills, sum.cuts, sum.stops);
}

TEST(Holders, RowsOfRobotsThatAreDeletedComeAnewUnderTheirLastHolder) {
  constexpr std::uint64_t kSeeds = 400;
  const HoldersResult sum = RunSeeds(kSeeds, Trouble::kRows);
  EXPECT_GT(sum.deletions, kSeeds);
  EXPECT_GT(sum.kills, kSeeds);
}

TEST(Holders, ASuspendMakesNobodyOffline) {
  constexpr std::uint64_t kSeeds = 420;
  EXPECT_GT(RunSeeds(kSeeds, Trouble::kSuspends).suspends, kSeeds);
}

TEST(Holders, AStoreThatWentBackLeavesOneHolderAndMakesNobodyOffline) {
  constexpr std::uint64_t kSeeds = 400;
  const HoldersResult sum = RunSeeds(kSeeds, Trouble::kFailovers);
  EXPECT_GT(sum.failovers, kSeeds);
  EXPECT_GT(sum.session_ends, kSeeds * 100);
}

TEST(Holders, ReplaysASeedToTheSameRow) {
  const auto run = [] { return HoldersWorld({.seed = 7}).Run(); };
  EXPECT_EQ(run().lines, run().lines);
}

/// Each planted fault must be found: a simulation that passes a broken server proves nothing.
struct Canary {
  HoldersFault fault = HoldersFault::kNone;
  Trouble trouble = Trouble::kAll;
};
class HoldersCanary : public ::testing::TestWithParam<Canary> {};

TEST_P(HoldersCanary, IsFound) {
  constexpr std::uint64_t kSeedsMax = 1'000;
  const auto [fault, trouble] = GetParam();
  for (std::uint64_t seed = 1; seed <= kSeedsMax; ++seed) {
    const HoldersResult result =
        HoldersWorld({.seed = seed, .trouble = trouble, .fault = fault}).Run();
    if (result.violation.empty()) continue;
    RecordProperty("violation", fmt::format("seed {}: {}", seed, result.violation));
    return;
  }
  FAIL() << "no seed finds it";
}

INSTANTIATE_TEST_SUITE_P(
    Simulation, HoldersCanary,
    ::testing::Values(
        Canary{HoldersFault::kHoldNotChecked}, Canary{HoldersFault::kOverAfterAFailedLook},
        Canary{HoldersFault::kAdoptedWithoutCompare}, Canary{HoldersFault::kEndedStreamTakes},
        Canary{HoldersFault::kStandstillJudges},
        Canary{HoldersFault::kStopsWithUnknown, Trouble::kUpdates},
        Canary{HoldersFault::kShortGrace}, Canary{HoldersFault::kSilenceForgotten},
        Canary{HoldersFault::kLateIsForgotten},
        Canary{HoldersFault::kSuspendUnnoticed, Trouble::kSuspends},
        Canary{HoldersFault::kHalfOpenAnswers}, Canary{HoldersFault::kNoGraceAfterStandstill},
        Canary{HoldersFault::kEpochsInEachRow, Trouble::kRows},
        Canary{HoldersFault::kReconnectExcuses, Trouble::kFailovers}));

}  // namespace
}  // namespace uplink::simulation
