#include "tools/uplink-fleet/scenario.h"

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
  for (const NamedScenario& named : NamedScenarios()) {
    const auto scenario = LoadScenario(std::string(named.name));
    ASSERT_TRUE(scenario.ok()) << named.name;
    EXPECT_EQ(scenario->options.rate_hz, named.scenario.options.rate_hz);
    EXPECT_EQ(scenario->breaks_per_minute, named.scenario.breaks_per_minute);
  }
}

TEST_F(ScenarioTest, AFileSetsWhatItNamesAndLeavesTheRest) {
  const auto scenario = Load("robots = 7\nrate = 2.5\nbreaks_per_minute = 3\nbatch = 4\npace = 2");
  ASSERT_TRUE(scenario.ok()) << scenario.status();
  EXPECT_EQ(scenario->robots, 7U);
  EXPECT_EQ(scenario->options.rate_hz, 2.5);
  EXPECT_EQ(scenario->breaks_per_minute, 3);
  EXPECT_EQ(scenario->batch, 4U);
  EXPECT_EQ(scenario->options.pace, 2);
  EXPECT_EQ(scenario->options.faults_hz, ScenarioOptions().faults_hz);
  EXPECT_EQ(scenario->options.malformed_share, 0);
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

TEST_F(ScenarioTest, NeitherNameNorFile) {
  const auto scenario = LoadScenario(folder_.File("missing"));
  EXPECT_THAT(std::string(scenario.status().message()), HasSubstr("neither a scenario's name"));
  EXPECT_THAT(ErrorOf("robots = = 1"), HasSubstr("scenario.toml"));
}

}  // namespace
}  // namespace uplink::synthetic
