// Parking and flapping, as parts of what is known of a robot's presence.
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/presence_track.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using std::chrono::hours;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class PresenceParkingTest : public ::testing::Test {
 protected:
  void Sign() { track_.AddSign(clock_.Steady(), clock_.System(), limits_); }
  void Park() { track_.Park(until_, SteadyTime::max(), clock_.Steady()); }
  Presence Sweep() {
    track_.SweepAround(clock_.Steady(), clock_.System(), limits_);
    return track_.Sweep(clock_.Steady(), clock_.System(), limits_);
  }
  void PassTimeout() { clock_.Advance(limits_.timeout + milliseconds(1)); }
  storage::StoredPresence Stored(Presence presence, std::optional<SystemTime> parked_until = {}) {
    return {presence, clock_.System(), parked_until};
  }

  testing::ManualClock clock_;
  const PresenceLimits limits_{};
  const SystemTime until_ = clock_.System() + hours(2);
  std::vector<storage::StoredPresence> told_;
  PresenceTrack track_{clock_.Steady(), clock_.Steady(), clock_.System(),
                       [this](const storage::StoredPresence& now) { told_.push_back(now); }};
};

TEST_F(PresenceParkingTest, AParkedRobotIsOfflineAfterTheTimeoutAsEver) {
  Sign();
  const SystemTime online = clock_.System();
  Park();
  PassTimeout();
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_THAT(told_,
              ElementsAre(storage::StoredPresence{Presence::kOnline, online},
                          storage::StoredPresence{Presence::kOnline, online, until_},
                          storage::StoredPresence{Presence::kOffline, clock_.System(), until_}));
}

TEST_F(PresenceParkingTest, ASignOfLifeIsToldOnceAsItsPresenceOrAsTheEndOfItsParking) {
  Sign();
  Park();
  track_.EndParkingStream(clock_.Steady());
  PassTimeout();
  Sweep();
  told_.clear();
  Sign();
  EXPECT_THAT(told_, ElementsAre(Stored(Presence::kOnline)));
  const SystemTime online = clock_.System();
  Park();
  track_.EndParkingStream(clock_.Steady());
  told_.clear();
  clock_.Advance(milliseconds(1));
  Sign();
  EXPECT_THAT(told_, ElementsAre(storage::StoredPresence{Presence::kOnline, online}));
  EXPECT_EQ(track_.parked_until(), std::nullopt);
}

TEST_F(PresenceParkingTest, ItsTimeEndsWithoutAWord) {
  Sign();
  Park();
  PassTimeout();
  Sweep();
  told_.clear();
  clock_.Advance(hours(2));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.parked_until(), std::nullopt);
  EXPECT_THAT(told_, IsEmpty()) << "each reader of the store sees by its clock that it is over";
}

TEST_F(PresenceParkingTest, AnAdoptedRobotStaysParked) {
  track_.Adopt({.stored = Stored(Presence::kOffline, until_),
                .unknown_until = clock_.Steady(),
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.parked_until(), until_);
  Sign();
  EXPECT_EQ(track_.parked_until(), std::nullopt);
  EXPECT_THAT(told_, ElementsAre(Stored(Presence::kOnline)));
}

TEST_F(PresenceParkingTest, ARobotThatAnotherJudgesIsParkedAsThatOneWrote) {
  track_.Follow(Stored(Presence::kOffline, until_));
  EXPECT_EQ(track_.parked_until(), until_);
  Sign();
  Park();
  EXPECT_EQ(track_.parked_until(), until_) << "nothing that comes here counts";
  clock_.Advance(hours(2));
  track_.SweepAround(clock_.Steady(), clock_.System(), limits_);
  EXPECT_EQ(track_.parked_until(), std::nullopt);
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(PresenceParkingTest, TheStoreThatAnswersLateDoesNotParkARobotThatSpeaksHere) {
  track_.BeginStream(clock_.Steady());
  Sign();
  told_.clear();
  track_.Claim(Stored(Presence::kOffline, until_), clock_.Steady());
  EXPECT_EQ(track_.parked_until(), std::nullopt);
  ASSERT_FALSE(told_.empty());
  EXPECT_EQ(told_.back().parked_until, std::nullopt);
}

TEST_F(PresenceParkingTest, TheStoreThatAnswersLateDoesNotForgetAGoodbyeHere) {
  track_.BeginStream(clock_.Steady());
  Sign();
  Park();
  told_.clear();
  track_.Claim(Stored(Presence::kUnknown), clock_.Steady());
  EXPECT_EQ(track_.parked_until(), until_);
  ASSERT_FALSE(told_.empty());
  EXPECT_EQ(told_.back().parked_until, until_) << "it was not written before";
}

TEST_F(PresenceParkingTest, AStreamThatBeginsFollowsTheStore) {
  Sign();
  clock_.Advance(milliseconds(1));
  track_.BeginStream(clock_.Steady());
  track_.Claim(Stored(Presence::kOffline, until_), clock_.Steady());
  EXPECT_EQ(track_.parked_until(), until_) << "what came before may be older than its Goodbye";
}

TEST_F(PresenceParkingTest, ComingAndGoingIsFlapping) {
  for (std::size_t i = 0; i < limits_.flaps.changes / 2; ++i) {
    Sign();
    Sweep();
    EXPECT_FALSE(track_.flapping());
    PassTimeout();
    EXPECT_EQ(Sweep(), Presence::kOffline);
  }
  Sign();
  Sweep();
  EXPECT_TRUE(track_.flapping());
  clock_.Advance(limits_.flaps.window);
  Sign();
  Sweep();
  EXPECT_FALSE(track_.flapping());
}

TEST_F(PresenceParkingTest, WhatTheServerCannotHearIsNoFlapping) {
  for (std::size_t i = 0; i < limits_.flaps.changes; ++i) {
    Sign();
    track_.AddStall(clock_.Steady() + limits_.timeout);
    PassTimeout();
    EXPECT_EQ(Sweep(), Presence::kUnknown);
  }
  EXPECT_FALSE(track_.flapping());
}

TEST_F(PresenceParkingTest, WhatAnotherJudgesFlapsAsThatOneWrites) {
  track_.Follow(Stored(Presence::kOnline));
  for (std::size_t i = 0; i < limits_.flaps.changes / 2; ++i) {
    track_.Follow(Stored(Presence::kOffline));
    track_.Follow(Stored(Presence::kOnline));
  }
  track_.SweepAround(clock_.Steady(), clock_.System(), limits_);
  EXPECT_TRUE(track_.flapping());
}

}  // namespace
}  // namespace uplink::robot
