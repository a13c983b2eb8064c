#pragma once

#include <string>

#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"
#include "tests/component/front/victim.h"

namespace uplink::testing {

/// An attack on the relay beside an honest robot. Whatever the attack is: the robot goes on
/// meanwhile, loses nothing, new robots are served, nothing of the attacker's is left, and the
/// process has not grown by more than kGrowthMax.
class Hostile : public ::testing::Test {
 protected:
  /// What attackers in this process keep themselves is in it.
  static constexpr std::size_t kGrowthMax = std::size_t{48} * 1024 * 1024;
  static constexpr int kVictim = 1;
  static constexpr int kAttacker = 666;

  explicit Hostile(const RelayWorld::Options& options = {}) : world_(options) {}

  void SetUp() override {
    ASSERT_TRUE(victim_.GoesOn());
    ASSERT_TRUE(ServesNewRobot(world_, 2));
    resident_before_ = ResidentBytes();
  }

  /// The attack is at its height: the victim notices nothing.
  void ExpectVictimGoesOn() { EXPECT_TRUE(victim_.GoesOn()); }

  void TearDown() override {
    if (kMemoryCounts) {
      EXPECT_LT(ResidentBytes(), resident_before_ + kGrowthMax);
    }
    EXPECT_TRUE(victim_.GoesOn());
    EXPECT_TRUE(ServesNewRobot(world_, 3));
    EXPECT_TRUE(Eventually([this] { return world_.server().streams() == 1; }))
        << world_.server().streams() << " streams, and the victim has one";
    EXPECT_TRUE(victim_.Finish());
    EXPECT_EQ(world_.database.Log(victim_.ruri(), Victim::session()).stored.size(),
              victim_.acked());
    EXPECT_TRUE(world_.Settles());
    EXPECT_EQ(world_.Counts().missing, 0U);
  }

  /// Waits until at least one connection was turned away for this.
  [[nodiscard]] bool Turned(transport::TurnedAway cause) {
    return Eventually([&] { return TurnedAwayFor(world_, cause) > 0; });
  }
  [[nodiscard]] RawHttp2::Options Attacker() {
    return ClientOf(world_, RobotKeys(world_, kAttacker), "127.0.0.66");
  }

  RelayWorld world_;
  Victim victim_{world_, kVictim};

 private:
  std::size_t resident_before_ = 0;
};

}  // namespace uplink::testing
