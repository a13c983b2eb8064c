#include "server/robot/presence_track.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

class PresenceTrackTest : public ::testing::Test {
 protected:
  PresenceTrack::Sign Sign() { return track_.AddSign(clock_.Steady(), clock_.System(), limits_); }
  Presence Sweep() { return track_.Sweep(clock_.Steady(), clock_.System(), limits_); }

  testing::ManualClock clock_;
  const PresenceLimits limits_{};
  std::vector<std::pair<Presence, SystemTime>> changes_;
  PresenceTrack track_{
      clock_.Steady(), clock_.Steady(), clock_.System(),
      [this](Presence presence, SystemTime at) { changes_.emplace_back(presence, at); }};
};

TEST_F(PresenceTrackTest, ASignOfLifeMakesARobotOnlineAndIsToldOnce) {
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  EXPECT_EQ(Sign(), PresenceTrack::Sign::kLatest);
  EXPECT_EQ(Sign(), PresenceTrack::Sign::kLatest);
  EXPECT_EQ(track_.presence(), Presence::kOnline);
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, clock_.System())));
}

TEST_F(PresenceTrackTest, AnOlderSignChangesNothing) {
  const SteadyTime before = clock_.Steady();
  const SystemTime before_system = clock_.System();
  clock_.Advance(std::chrono::seconds(1));
  Sign();
  EXPECT_EQ(track_.AddSign(before, before_system, limits_), PresenceTrack::Sign::kOlder);
  EXPECT_EQ(track_.last_sign(), clock_.System());
}

TEST_F(PresenceTrackTest, SilenceWhileHeldBackIsNotOffline) {
  Sign();
  track_.SetReading(PresenceTrack::Reading::kHeldBack, clock_.Steady());
  EXPECT_TRUE(track_.held_back());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  track_.SetReading(PresenceTrack::Reading::kFlowing, clock_.Steady());
  EXPECT_EQ(track_.stream_held_back_until(), clock_.Steady());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AStallKeepsWhoWasOfflineOffline) {
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  track_.AddStall(clock_.Steady());
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhatAnEarlierLifeHeardIsKeptUntilASignComes) {
  const SystemTime earlier = clock_.System() - std::chrono::hours(1);
  track_.Restore(earlier);
  EXPECT_EQ(track_.last_sign(), earlier);
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  Sign();
  track_.Restore(earlier);
  EXPECT_EQ(track_.last_sign(), clock_.System());
}

}  // namespace
}  // namespace uplink::robot
