#include "server/run/supervisor.h"

#include <gtest/gtest.h>

namespace uplink::run {
namespace {

TEST(WatchdogTest, IsFedWhileRobotsWouldBeAnsweredAndNotElse) {
  bool alive = true;
  int fed = 0;
  const Watchdog watchdog({.alive = [&] { return alive; }, .feed = [&] { ++fed; }});
  watchdog.Beat();
  watchdog.Beat();
  EXPECT_EQ(fed, 2);
  alive = false;
  watchdog.Beat();
  EXPECT_EQ(fed, 2);
  alive = true;
  watchdog.Beat();
  EXPECT_EQ(fed, 3);
}

}  // namespace
}  // namespace uplink::run
