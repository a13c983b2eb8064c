#include "tools/uplink-fleet/scenario/scenario.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace uplink::synthetic {
namespace {

using ::testing::HasSubstr;

class ScenarioTest : public ::testing::Test {
 protected:
  absl::StatusOr<Scenario> Load(const std::string& text) {
    std::ofstream(path_) << text;
    return LoadScenario(path_);
  }
  std::string ErrorOf(const std::string& text) {
    const auto scenario = Load(text);
    EXPECT_EQ(scenario.status().code(), absl::StatusCode::kInvalidArgument) << text;
    return std::string(scenario.status().message());
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("scenario.toml");
};

TEST_F(ScenarioTest, EveryNameLoads) {
  for (const std::string& name : ScenarioNames()) {
    const auto scenario = LoadScenario(name);
    ASSERT_TRUE(scenario.ok()) << name << ": " << scenario.status();
    EXPECT_FALSE(scenario->about.empty()) << name;
  }
  EXPECT_THAT(ScenarioNames(), ::testing::IsSupersetOf({"calm", "rough", "storm", "idle"}));
  EXPECT_EQ(LoadScenario("rough")->phases.front().trouble.breaks_per_minute, 2);
  EXPECT_EQ(LoadScenario("rough")->phases.front().options.malformed_share, 0.01);
}

TEST_F(ScenarioTest, AFileSetsWhatItNamesAndLeavesTheRest) {
  const auto scenario = Load("robots = 7\nrate = 2.5\nbreaks_per_minute = 3\nbatch = 4\npace = 2");
  ASSERT_TRUE(scenario.ok()) << scenario.status();
  EXPECT_EQ(scenario->robots, 7U);
  const Phase& phase = scenario->phases.front();
  EXPECT_EQ(phase.options.rate_hz, 2.5);
  EXPECT_EQ(phase.trouble.breaks_per_minute, 3);
  EXPECT_EQ(phase.batch, 4U);
  EXPECT_EQ(phase.options.pace, 2);
  EXPECT_EQ(phase.options.faults_hz, ScenarioOptions().faults_hz);
  EXPECT_EQ(phase.options.malformed_share, 0);
}

TEST_F(ScenarioTest, TroubleIsRead) {
  const auto scenario = Load(
      "flood = true\nlost_answers = 0.25\ndelay = \"100ms\"\nstorm_every = "
      "\"20s\"\ncuts_per_minute = 1\n"
      "half_opens_per_minute = 2\ntakeovers_per_minute = 3\nslow_readers = 0.5\n"
      "offline_before = \"1h\"\nconnects_per_second = 50\nstatus = 0.25");
  ASSERT_TRUE(scenario.ok()) << scenario.status();
  EXPECT_EQ(scenario->offline_before, std::chrono::hours(1));
  EXPECT_EQ(scenario->connects_per_second, 50);
  const Phase& phase = scenario->phases.front();
  EXPECT_TRUE(phase.flood);
  EXPECT_EQ(phase.options.status_hz, 0.25);
  EXPECT_EQ(phase.trouble.delay, milliseconds(100));
  EXPECT_EQ(phase.trouble.storm_every, std::chrono::seconds(20));
  EXPECT_EQ(phase.trouble.cuts_per_minute, 1);
  EXPECT_EQ(phase.trouble.half_opens_per_minute, 2);
  EXPECT_EQ(phase.trouble.takeovers_per_minute, 3);
  EXPECT_EQ(phase.trouble.slow_readers, 0.5);
  EXPECT_EQ(phase.trouble.lost_answers, 0.25);
}

TEST_F(ScenarioTest, PhasesFollowEachOtherAgainAndAgain) {
  const auto scenario = Load(
      "rate = 2\nbatch = 3\n[[phase]]\nfor = \"10s\"\nrate = 5\n[[phase]]\nfor = \"20s\"\n"
      "batch = 7");
  ASSERT_TRUE(scenario.ok()) << scenario.status();
  ASSERT_EQ(scenario->phases.size(), 2U);
  const auto at = [&](int ms) { return scenario->At(milliseconds(ms)); };
  EXPECT_EQ(at(0).options.rate_hz, 5);
  EXPECT_EQ(at(0).batch, 3U);
  EXPECT_EQ(at(9999).options.rate_hz, 5);
  EXPECT_EQ(at(10'000).options.rate_hz, 2);
  EXPECT_EQ(at(10'000).batch, 7U);
  EXPECT_EQ(at(29'999).batch, 7U);
  EXPECT_EQ(at(30'000).options.rate_hz, 5);
  EXPECT_EQ(at(-1).options.rate_hz, 5);
}

TEST_F(ScenarioTest, WrongPhasesAndDurationsAreNamed) {
  EXPECT_THAT(ErrorOf("phase = 1"), HasSubstr("phase takes 1 to 32 tables"));
  EXPECT_THAT(ErrorOf("phase = [1]"), HasSubstr("phase takes tables"));
  EXPECT_THAT(ErrorOf("[[phase]]\nrate = 1"), HasSubstr("for how long it lasts"));
  EXPECT_THAT(ErrorOf("[[phase]]\nfor = \"1s\"\nrobots = 1"), HasSubstr("no such key: robots"));
  EXPECT_THAT(ErrorOf("delay = 5"), HasSubstr("delay takes a duration"));
  EXPECT_THAT(ErrorOf("delay = \"11s\""), HasSubstr("up to 10s"));
  EXPECT_THAT(ErrorOf("flood = 1"), HasSubstr("flood takes true or false"));
  EXPECT_THAT(ErrorOf("for = \"1s\""), HasSubstr("no such key: for"));
}

TEST_F(ScenarioTest, LimitsAreInAndWhatIsBeyondIsNamed) {
  EXPECT_TRUE(Load("malformed_share = 1").ok());
  EXPECT_TRUE(Load("robots = 50000").ok());
  EXPECT_THAT(ErrorOf("malformed_share = 1.01"), HasSubstr("malformed_share takes a number from"));
  EXPECT_THAT(ErrorOf("robots = 0"), HasSubstr("robots takes a whole number from 1 to 50000"));
  EXPECT_THAT(ErrorOf("robots = 1.5"), HasSubstr("whole number"));
  EXPECT_THAT(ErrorOf("rate = nan"), HasSubstr("rate takes"));
  EXPECT_THAT(ErrorOf("rate = \"fast\""), HasSubstr("rate takes"));
  EXPECT_THAT(ErrorOf("speed = 1"), HasSubstr("no such key: speed"));
}

TEST_F(ScenarioTest, SharesOfRobotsThatDeclineAndThatComeLate) {
  Scenario scenario = Load("robots = 20\ndeclining_share = 0.1\nlate_share = 0.1").value();
  std::size_t declining = 0;
  std::size_t late = 0;
  for (std::size_t i = 0; i < scenario.robots; ++i) {
    declining += Declines(scenario, i) ? 1U : 0U;
    late += JoinsLate(scenario, i) ? 1U : 0U;
    EXPECT_FALSE(Declines(scenario, i) && JoinsLate(scenario, i)) << i;
  }
  EXPECT_EQ(declining, 2U);
  EXPECT_EQ(late, 2U);
  EXPECT_TRUE(Declines(Load("declining_share = 1").value(), 0));
  EXPECT_FALSE(Declines(Load("declining_share = 0").value(), 9));
  EXPECT_THAT(ErrorOf("declining_share = 1.1"), HasSubstr("declining_share takes"));
  EXPECT_THAT(ErrorOf("late_share = -0.1"), HasSubstr("late_share takes"));
  EXPECT_THAT(ErrorOf("[[phase]]\nfor = \"1s\"\nlate_share = 0"), HasSubstr("no such key"));
}

TEST_F(ScenarioTest, NeitherNameNorFile) {
  const auto scenario = LoadScenario(folder_.File("missing"));
  EXPECT_THAT(std::string(scenario.status().message()), HasSubstr("neither a scenario's name"));
  EXPECT_THAT(ErrorOf("robots = = 1"), HasSubstr("scenario.toml"));
}

}  // namespace
}  // namespace uplink::synthetic
