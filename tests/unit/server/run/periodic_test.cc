#include "server/run/periodic.h"

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::run {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(PeriodicTest, EachIsDoneAtItsInterval) {
  std::vector<std::pair<milliseconds, std::string>> done;
  std::string now;
  DoPeriodically(
      [&](milliseconds interval, const std::function<void()>& job) {
        job();
        done.emplace_back(interval, now);
      },
      {.sweep = [&now] { now = "sweep"; },
       .look_at_certificate = [&now] { now = "certificate"; },
       .look_at_access = [&now] { now = "access"; },
       .look_at_store = [&now] { now = "store"; },
       .read_robots = [&now] { now = "robots"; },
       .ask_for_snapshot = [&now] { now = "snapshot"; },
       .look_at_space = [&now] { now = "space"; },
       .look_at_clock = [&now] { now = "clock"; },
       .count_faults = [&now] { now = "faults"; },
       .look_at_top = [&now] { now = "top"; },
       .look_at_drones = [&now] { now = "drones"; },
       .ask_relay = [&now] { now = "relay"; },
       .look_at_config = [&now] { now = "config"; },
       .write_audit = [&now] { now = "audit"; },
       .feed_watchdog = [&now] { now = "watchdog"; }});
  EXPECT_THAT(
      done,
      ElementsAre(Pair(std::chrono::seconds(1), "sweep"),
                  Pair(std::chrono::seconds(5), "certificate"),
                  Pair(std::chrono::seconds(2), "access"), Pair(std::chrono::seconds(1), "store"),
                  Pair(milliseconds(500), "robots"), Pair(std::chrono::seconds(10), "snapshot"),
                  Pair(std::chrono::seconds(2), "space"), Pair(std::chrono::seconds(5), "clock"),
                  Pair(std::chrono::seconds(10), "faults"), Pair(std::chrono::seconds(5), "top"),
                  Pair(std::chrono::seconds(1), "drones"), Pair(std::chrono::seconds(2), "relay"),
                  Pair(std::chrono::seconds(2), "config"), Pair(std::chrono::seconds(1), "audit"),
                  Pair(std::chrono::seconds(10), "watchdog")));
}

}  // namespace
}  // namespace uplink::run
