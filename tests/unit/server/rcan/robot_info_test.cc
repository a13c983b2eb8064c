#include "server/rcan/robot_info.h"

#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::rcan {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class RobotInfoTest : public ::testing::Test {
 protected:
  /// The sample of a robot that says it runs this.
  std::string Sample(const std::string& software, const std::string& agent = "") {
    page_.Clear();
    page_.BeginRobot("rcan://a/mower-7");
    AddInfo({.ruri = "rcan://a/mower-7",
             .fleet = "north",
             .software_version = software,
             .agent_version = agent},
            infos_, rules_, now_, page_);
    EXPECT_TRUE(page_.EndRobot());
    std::string text;
    page_.Write(metrics::Format::kText, text);
    return text.substr(text.rfind("\nrcan") + 1);
  }

  SteadyTime now_ = SteadyTime(std::chrono::hours(1));
  SeriesNames infos_;
  const NameRules rules_{
      NameHash({1, 2}),
      {.names_max = 512, .new_per_hour = 2, .forget_after = std::chrono::minutes(10)}};
  metrics::rcan::SeriesPage page_{{.series_max = 10}};
};

TEST_F(RobotInfoTest, SaysWhatTheRobotIs) {
  EXPECT_EQ(Sample("5.1", "2.0"),
            "rcan_robot_info{fleet=\"north\",name=\"mower-7\",software_version=\"5.1\","
            "agent_version=\"2.0\",ruri=\"rcan://a/mower-7\"} 1\n");
  EXPECT_THAT(Sample(""), HasSubstr("software_version=\"\",agent_version=\"\""));
  EXPECT_THAT(Sample("a\"b\n"), HasSubstr(R"(software_version="a\"b\n")"));
}

TEST_F(RobotInfoTest, ARobotThatKeepsChangingItsVersionAddsABoundedNumberOfSeries) {
  std::size_t shown = 0;
  for (int i = 0; i < 240; ++i, now_ += std::chrono::seconds(15)) {
    const std::string sample = Sample("v" + std::to_string(i));
    EXPECT_THAT(sample, StartsWith("rcan_robot_info{fleet=\"north\",name=\"mower-7\","));
    if (sample.find("\"v") != std::string::npos) ++shown;
  }
  EXPECT_GE(shown, kInfosMax);
  EXPECT_LE(shown, kInfosMax + 2 + 2) << "an hour of new names, and a full bucket";
}

TEST_F(RobotInfoTest, AKnownVersionStays) {
  for (int i = 0; i < 100; ++i) EXPECT_THAT(Sample("5.1"), HasSubstr("\"5.1\""));
}

TEST(NameOf, IsTheLastSegment) {
  EXPECT_EQ(NameOf("rcan://host/acme/x1/r17"), "r17");
  EXPECT_EQ(NameOf("rcan://host/r17/"), "r17");
  EXPECT_EQ(NameOf("r17"), "r17");
  EXPECT_EQ(NameOf(""), "");
  EXPECT_EQ(NameOf("/"), "");
}

}  // namespace
}  // namespace uplink::rcan
