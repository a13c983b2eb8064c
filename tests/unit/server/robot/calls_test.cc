#include "server/robot/calls.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "server/robot/robot.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

class CallsTest : public ::testing::Test {
 protected:
  /// The journal may let go of it.
  [[nodiscard]] bool Leaves() {
    static_cast<void>(robot_.Stay());
    EXPECT_TRUE(robot_.BeginLeaving(Robot::LeaveWhen::kAtOnce));
    return robot_.MayLeave();
  }

  testing::ManualClock clock_;
  const PresenceChanged untold_;
  Robot robot_{std::make_shared<const model::RobotId>(
                   model::RobotId{.ruri = "rcan://drone", .fleet = "north"}),
               clock_.Steady(), clock_, untold_};
};

TEST_F(CallsTest, ARobotStaysInMemoryWhileItsCallsAreServed) {
  EXPECT_TRUE(Leaves());
  robot_.calls.Begin(nullptr);
  EXPECT_TRUE(robot_.speaks());
  EXPECT_FALSE(robot_.HasStream());
  EXPECT_FALSE(robot_.idle());
  EXPECT_FALSE(Leaves());
  robot_.calls.Begin(nullptr);
  robot_.calls.End(nullptr);
  EXPECT_FALSE(Leaves()) << "of two who served them one is left";
  robot_.calls.End(nullptr);
  EXPECT_TRUE(robot_.idle());
  EXPECT_TRUE(Leaves());
}

TEST_F(CallsTest, WhatWaitsOfThemCountsWithWhatWaitsOfStreams) {
  const model::SessionId session({1});
  static_cast<void>(robot_.sessions.Begin(session, clock_.Steady()));
  EXPECT_EQ(robot_.sessions.AddWaiting(session, 1, 100), 1);
  robot_.calls.AddWaiting({.records = 2, .bytes = 50});
  EXPECT_EQ(robot_.journal_use().records, 3U);
  EXPECT_EQ(robot_.journal_use().bytes, 150U);
  robot_.calls.EndWaiting({.records = 1, .bytes = 20});
  EXPECT_EQ(robot_.journal_use().records, 2U);
  EXPECT_EQ(robot_.journal_use().bytes, 130U);
}

TEST_F(CallsTest, AreAskedToEndForAWhileWhoeverServesThem) {
  const SteadyTime now = clock_.Steady();
  EXPECT_FALSE(robot_.calls.asked_to_end(now));
  robot_.calls.AskToEnd(now + std::chrono::seconds(5));
  EXPECT_TRUE(robot_.calls.asked_to_end(now));
  robot_.calls.Begin(nullptr);
  robot_.calls.End(nullptr);
  EXPECT_TRUE(robot_.calls.asked_to_end(now)) << "a call between does not keep it";
  EXPECT_FALSE(robot_.calls.asked_to_end(now + std::chrono::seconds(5))) << "it stayed";
}

TEST_F(CallsTest, WhatTheySayCountsAndIsDroppedAsLongAsTheyAreServed) {
  class Live final : public CallsLive {
   public:
    [[nodiscard]] std::size_t live_bytes() const override { return bytes_; }
    std::size_t DropLive() override { return std::exchange(bytes_, 0); }

   private:
    std::size_t bytes_ = 7;
  };
  Live live;
  Live other;
  EXPECT_EQ(robot_.calls.live_bytes(), 0U);
  EXPECT_FALSE(robot_.calls.spoke());
  robot_.calls.Begin(&live);
  EXPECT_EQ(robot_.calls.live_bytes(), 7U);
  EXPECT_EQ(robot_.calls.DropLive(), 7U);
  EXPECT_EQ(robot_.calls.live_bytes(), 0U);
  robot_.calls.Begin(&other);
  robot_.calls.End(&live);
  EXPECT_EQ(robot_.calls.live_bytes(), 7U) << "those that are served now";
  robot_.calls.End(&other);
  EXPECT_EQ(robot_.calls.live_bytes(), 0U);
  EXPECT_TRUE(robot_.calls.spoke());
}

TEST_F(CallsTest, ADisownedRobotIsOfItsFleetAndNothingOfItIsKnown) {
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  robot_.Disown("north", "south");
  EXPECT_EQ(robot_.id()->fleet, "south");
  EXPECT_TRUE(robot_.state.foreign());
  EXPECT_EQ(robot_.state.presence(), Presence::kUnknown);
}

TEST_F(CallsTest, ADisownedRobotThatIsHeldHereStaysKnown) {
  robot_.OnHeld({.since = 3});
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  robot_.Disown("elsewhere", "south");
  EXPECT_EQ(robot_.id()->fleet, "north") << "it was moved meanwhile";
  EXPECT_FALSE(robot_.state.foreign());
  EXPECT_EQ(robot_.state.presence(), Presence::kOnline);
}

TEST_F(CallsTest, ARobotThatAClaimFoundElsewhereIsKnownByItsHolder) {
  robot_.OnHeldElsewhere(storage::StoredPresence{Presence::kOnline, clock_.System()});
  EXPECT_TRUE(robot_.state.foreign());
  EXPECT_EQ(robot_.state.presence(), Presence::kOnline);
  robot_.state.FollowHolder({.held_by = "b", .written_at = {}},
                            {Presence::kOnline, clock_.System()});
  robot_.OnHeldElsewhere(std::nullopt);
  EXPECT_EQ(robot_.state.Snapshot(RobotState::Parts::kNone).foreign->held_by, "b")
      << "who holds it is known already";
}

TEST_F(CallsTest, ARobotWithAStreamHereIsNotElsewhereForAClaim) {
  robot_.state.Claim(clock_.Steady());
  robot_.OnHeldElsewhere(storage::StoredPresence{Presence::kOnline, clock_.System()});
  EXPECT_FALSE(robot_.state.foreign());
}

TEST_F(CallsTest, CallsAloneKeepARobotOnlineThatAClaimTook) {
  // As another process wrote it last.
  robot_.state.FollowHolder({.held_by = "b", .written_at = {}},
                            {Presence::kOffline, clock_.System()});
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  EXPECT_EQ(robot_.state.presence(), Presence::kOffline) << "that one judges it";
  robot_.OnHeld({.since = 3, .presence = storage::StoredPresence{Presence::kOffline, {}}});
  robot_.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  EXPECT_EQ(robot_.state.presence(), Presence::kOnline);
  robot_.state.FollowHolder({.held_by = "b", .written_at = {}},
                            {Presence::kOffline, clock_.System()});
  EXPECT_FALSE(robot_.state.foreign()) << "a look at the store that began before the claim";
  const PresenceLimits limits{};
  clock_.Advance(limits.timeout + milliseconds(1));
  EXPECT_EQ(robot_.state.Sweep(clock_.Steady(), clock_.System(), limits), Presence::kOffline);
}

}  // namespace
}  // namespace uplink::robot
