#include "server/session/frame_live.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {
namespace {

class FrameLiveTest : public ::testing::Test {
 protected:
  model::Record Judged(const std::string& payload) {
    return std::get<model::Record>(judge_.Payload(test::AsPayload(payload)).verdict);
  }
  robot::LiveParts Parts() { return state_.Snapshot(robot::RobotState::Parts::kAll).parts; }

  testing::ManualClock clock_;
  schema::Judge judge_{schema::JudgeLimits{}};
  robot::RobotState state_{clock_.Steady(), clock_.Steady(), clock_.System()};
  FrameLive live_;
};

TEST_F(FrameLiveTest, ALaterMotionReplacesTheOneBefore) {
  EXPECT_FALSE(live_.Add(Judged(Motion(47))).has_value());
  const auto replaced = live_.Add(Judged(Motion(46)));
  ASSERT_TRUE(replaced.has_value());
  EXPECT_EQ(std::get<model::MotionTelemetry>(replaced->body()).pose->lat_deg, 47);
  EXPECT_EQ(live_.Apply(state_, clock_.Steady(), judge_), 1U);
  EXPECT_EQ(Parts().motion->pose->lat_deg, 46);
}

TEST_F(FrameLiveTest, ALaterRobotStateReplacesTheOneBefore) {
  EXPECT_EQ(live_.Add(model::RcanState{.timestamp_us = 1}), FrameLive::Before::kNone);
  EXPECT_EQ(live_.Add(model::RcanState{.timestamp_us = 2}), FrameLive::Before::kReplaced);
  EXPECT_EQ(live_.Apply(state_, clock_.Steady(), judge_), 1U);
  EXPECT_EQ(Parts().rcan->timestamp_us, 2);
}

TEST_F(FrameLiveTest, WhatWasAppliedIsGone) {
  EXPECT_FALSE(live_.Add(Judged(Motion(47))).has_value());
  EXPECT_EQ(live_.Add(model::RcanState{.timestamp_us = 1}), FrameLive::Before::kNone);
  EXPECT_EQ(live_.Apply(state_, clock_.Steady(), judge_), 2U);
  EXPECT_EQ(live_.Apply(state_, clock_.Steady(), judge_), 0U);
  EXPECT_EQ(live_.Add(model::RcanState{.timestamp_us = 2}), FrameLive::Before::kNone);
}

}  // namespace
}  // namespace uplink::session
