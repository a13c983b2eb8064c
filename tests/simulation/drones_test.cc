// Drones that call two servers on one fake store (DronesWorld).
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/simulation/drones_world.h"

namespace uplink::simulation {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(DronesWorld, AnswersAreTrueAndEachSampleIsStoredOnceWhereverItIsSent) {
  constexpr std::uint64_t kSeeds = 1'000;
  DronesResult sum;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    FakeDronesBackend backend;
    const DronesResult result = DronesWorld(backend, {.seed = seed}).Run();
    ASSERT_EQ(result.violation, "");
    for (const auto& [end, count] : result.ends) sum.ends[end] += count;
    sum.lost_answers += result.lost_answers;
    sum.late_calls += result.late_calls;
    sum.moves += result.moves;
    sum.kills += result.kills;
    sum.stops += result.stops;
    sum.claims += result.claims;
    sum.fenced += result.fenced;
    sum.duplicates += result.duplicates;
  }
  // The schedules must really have exercised what they claim to.
  EXPECT_GT(sum.ends["STORED"], kSeeds * 3);
  EXPECT_GT(sum.ends["APPLIED"], kSeeds * 3);
  EXPECT_GT(sum.ends["SUPERSEDED"], kSeeds);
  EXPECT_GT(sum.ends["DUPLICATE"], kSeeds / 4);
  EXPECT_GT(sum.ends["REJECTED"], kSeeds / 2);
  EXPECT_GT(sum.ends["UNAVAILABLE"], kSeeds / 2);
  EXPECT_GT(sum.lost_answers, kSeeds);
  EXPECT_GT(sum.late_calls, kSeeds / 4);
  EXPECT_GT(sum.moves, kSeeds / 2);
  EXPECT_GT(sum.kills, kSeeds / 2);
  EXPECT_GT(sum.stops, kSeeds / 4);
  EXPECT_GT(sum.claims, kSeeds * 2);
  EXPECT_GT(sum.fenced, kSeeds / 10);
  EXPECT_GT(sum.duplicates, kSeeds / 20);
  fmt::print("{} seeds:\n{}", kSeeds, ToText(sum));
}

/// What a run of this seed tells.
std::vector<std::string> LinesOf(std::uint64_t seed) {
  std::vector<std::string> lines;
  Trace trace([&lines](std::string_view line) { lines.emplace_back(line); });
  FakeDronesBackend backend;
  static_cast<void>(DronesWorld(backend, {.seed = seed, .trace = &trace}).Run());
  return lines;
}

TEST(DronesWorld, ReplaysASeedToTheSameStep) { EXPECT_EQ(LinesOf(7), LinesOf(7)); }

TEST(DronesWorld, ATraceShowsWhatDronesSendAndServersAnswer) {
  const std::vector<std::string> lines = LinesOf(7);
  EXPECT_THAT(lines, Contains(AllOf(HasSubstr("uav/0 sends "), HasSubstr(" to "))));
  EXPECT_THAT(lines, Contains(AllOf(HasSubstr(" answers "), HasSubstr(": STORED"))));
  EXPECT_THAT(lines, Contains(HasSubstr("store ClaimDrones")));
}

}  // namespace
}  // namespace uplink::simulation
