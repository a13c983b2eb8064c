#include "server/fleet/gateway_robots.h"

#include <gtest/gtest.h>

#include "server/fleet/fleet.h"
#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

TEST(GatewayRobots, IsBoundedPerGateway) {
  GatewayRobots gateway_robots(2);
  EXPECT_TRUE(gateway_robots.Add("rcan://a/1", "g"));
  EXPECT_TRUE(gateway_robots.Add("rcan://a/2", "g"));
  EXPECT_FALSE(gateway_robots.Add("rcan://a/3", "g"));
  EXPECT_TRUE(gateway_robots.Add("rcan://a/3", "another"));
  EXPECT_EQ(gateway_robots.of("g"), 2U);
  EXPECT_EQ(gateway_robots.of("another"), 1U);
}

TEST(GatewayRobots, ARobotThatLeftGivesItsPlaceBack) {
  GatewayRobots gateway_robots(1);
  ASSERT_TRUE(gateway_robots.Add("rcan://a/1", "g"));
  gateway_robots.Remove("rcan://a/1");
  gateway_robots.Remove("rcan://a/1");
  EXPECT_EQ(gateway_robots.of("g"), 0U);
  EXPECT_TRUE(gateway_robots.Add("rcan://a/2", "g"));
}

TEST(GatewayRobots, OneGatewayLeavesAQuarterToOthers) {
  EXPECT_EQ(GatewayRobotsMax(1), 1U);
  EXPECT_EQ(GatewayRobotsMax(4), 3U);
  EXPECT_EQ(GatewayRobotsMax(5'461), 4'095U);
  EXPECT_EQ(GatewayRobotsMax(20'000), 4'096U);
}

class FleetClaimTest : public ::testing::Test {
 protected:
  Fleet::Admission Come(const std::string& ruri, Grant grant, const std::string& fleet = "north") {
    return fleet_.FindOrAdmitBy({.robot = {.ruri = ruri, .fleet = fleet},
                                 .grant = grant,
                                 .gateway = grant == Grant::kOwn ? "" : "g"});
  }
  testing::ManualClock clock_;
  Fleet fleet_{clock_, 4, {}};
};

TEST_F(FleetClaimTest, AWordForTheRobotItselfCountsNoMore) {
  ASSERT_NE(Come("rcan://a/1", Grant::kFleet).robot, nullptr);
  ASSERT_NE(Come("rcan://a/2", Grant::kFleet).robot, nullptr);
  EXPECT_EQ(fleet_.gateway_robots("g"), 2U);
  EXPECT_NE(Come("rcan://a/1", Grant::kOwn).robot, nullptr);
  EXPECT_EQ(fleet_.gateway_robots("g"), 1U);
  EXPECT_NE(Come("rcan://a/2", Grant::kNamed).robot, nullptr);
  EXPECT_EQ(fleet_.gateway_robots("g"), 0U);
  EXPECT_NE(Come("rcan://a/1", Grant::kFleet).robot, nullptr);
  EXPECT_EQ(fleet_.gateway_robots("g"), 0U) << "it was here before";
}

TEST_F(FleetClaimTest, WhatIsRefusedTakesNoPlace) {
  for (const char* ruri : {"rcan://a/1", "rcan://a/2", "rcan://a/3"}) {
    ASSERT_NE(Come(ruri, Grant::kFleet).robot, nullptr);
  }
  EXPECT_EQ(Come("rcan://a/4", Grant::kFleet).refusal, Refusal::kGatewayFull);
  ASSERT_NE(Come("rcan://own", Grant::kOwn).robot, nullptr);
  EXPECT_EQ(Come("rcan://b", Grant::kNamed).refusal, Refusal::kFull);
  EXPECT_EQ(Come("rcan://own", Grant::kFleet, "south").refusal, Refusal::kOtherFleet);
  EXPECT_EQ(fleet_.Find("rcan://own")->id()->fleet, "north");
  EXPECT_EQ(fleet_.gateway_robots("g"), 3U);
  EXPECT_EQ(fleet_.size(), 4U);
}

TEST_F(FleetClaimTest, ARobotThatLeavesMemoryIsCountedNoMore) {
  robot::Robot* robot = Come("rcan://a/1", Grant::kFleet).robot.get();
  ASSERT_TRUE(fleet_.BeginLeaving(*robot));
  robot->OnLeft();
  EXPECT_EQ(fleet_.RemoveLeft().size(), 1U);
  EXPECT_EQ(fleet_.gateway_robots("g"), 0U);
}

}  // namespace
}  // namespace uplink::fleet
