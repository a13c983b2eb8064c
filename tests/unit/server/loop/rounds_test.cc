#include "server/loop/rounds.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <latch>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

#include "tests/support/eventually.h"

namespace uplink::loop {
namespace {

using std::chrono::hours;
using testing::Eventually;

constexpr milliseconds kShort{20};

/// Rounds that note when they begin.
class NotedRounds {
 public:
  explicit NotedRounds(Next next) : next_(next) {}

  Next operator()() {
    const SteadyTime now = SystemClock{}.Steady();
    const std::lock_guard lock(mutex_);
    begun_.push_back(now);
    return next_;
  }
  [[nodiscard]] bool Reach(std::size_t rounds) {
    return Eventually([&] { return begun().size() >= rounds; });
  }
  [[nodiscard]] std::vector<SteadyTime> begun() {
    const std::lock_guard lock(mutex_);
    return begun_;
  }

 private:
  const Next next_;
  std::mutex mutex_;
  std::vector<SteadyTime> begun_;
};

TEST(RoundsTest, OneFollowsTheOtherAtOnce) {
  NotedRounds noted({});
  Rounds rounds("noted", [&](const auto&) { return noted(); });
  rounds.Start();
  EXPECT_TRUE(noted.Reach(3));
}

TEST(RoundsTest, TheNextOneComesAfterItsTimeThoughNothingWakesIt) {
  NotedRounds noted({.within = kShort});
  Rounds rounds("noted", [&](const auto&) { return noted(); });
  rounds.Start();
  ASSERT_TRUE(noted.Reach(2));
  EXPECT_GE(noted.begun()[1] - noted.begun()[0], kShort);
}

TEST(RoundsTest, ItComesInTimeThoughAWakeMayNotMakeItSoonerOrMightHaveLongAgo) {
  for (const milliseconds not_before : {milliseconds(hours(1)), milliseconds(-hours(1))}) {
    NotedRounds noted({.within = kShort, .not_before = not_before});
    Rounds rounds("noted", [&](const auto&) { return noted(); });
    rounds.Start();
    EXPECT_TRUE(noted.Reach(2));
  }
}

TEST(RoundsTest, AWakeEndsTheWait) {
  NotedRounds noted({.within = hours(1)});
  Rounds rounds("noted", [&](const auto&) { return noted(); });
  rounds.Start();
  for (std::size_t count = 1; count < 4; ++count) {
    ASSERT_TRUE(noted.Reach(count));
    rounds.Wake();
  }
  EXPECT_TRUE(noted.Reach(4));
}

TEST(RoundsTest, AWakeDuringARoundIsNotLost) {
  std::latch under_way(1);
  std::latch woken(1);
  std::atomic<int> count = 0;
  Rounds rounds("noted", [&](const auto&) -> Next {
    if (++count == 1) {
      under_way.count_down();
      woken.wait();
    }
    return {.within = hours(1)};
  });
  rounds.Start();
  under_way.wait();
  rounds.Wake();
  woken.count_down();
  EXPECT_TRUE(Eventually([&] { return count == 2; }));
}

TEST(RoundsTest, AWakeDuringABackOffMakesNoRoundSoonerAndIsNotLost) {
  NotedRounds noted({.within = hours(1), .not_before = kShort});
  Rounds rounds("noted", [&](const auto&) { return noted(); });
  rounds.Start();
  ASSERT_TRUE(noted.Reach(1));
  rounds.Wake();
  ASSERT_TRUE(noted.Reach(2));
  EXPECT_GE(noted.begun()[1] - noted.begun()[0], kShort);
}

TEST(RoundsTest, TheThreadHasItsName) {
  std::latch named(1);
  std::string name(16, '\0');
  Rounds rounds("fifteen_letters", [&](const auto&) -> Next {
    pthread_getname_np(pthread_self(), name.data(), name.size());
    named.count_down();
    return {.within = hours(1)};
  });
  rounds.Start();
  named.wait();
  EXPECT_STREQ(name.c_str(), "fifteen_letters");
}

TEST(RoundsTest, AStopEndsAWaitAndABackOff) {
  for (const Next next : {Next{.within = hours(1)}, {.within = hours(1), .not_before = hours(1)}}) {
    NotedRounds noted(next);
    Rounds rounds("noted", [&](const auto&) { return noted(); });
    rounds.Start();
    ASSERT_TRUE(noted.Reach(1));
    rounds.Stop();
    rounds.Stop();
    rounds.Wake();
    EXPECT_EQ(noted.begun().size(), 1U);
  }
}

TEST(RoundsTest, AStopWaitsForTheRoundUnderWayWhichMayEndItsOwnWaitByIt) {
  std::latch under_way(1);
  std::atomic<bool> ended = false;
  Rounds rounds("noted", [&](const std::stop_token& stop) -> Next {
    under_way.count_down();
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait(lock, stop, [] { return false; });
    ended = true;
    return {};
  });
  rounds.Start();
  under_way.wait();
  rounds.Stop();
  EXPECT_TRUE(ended);
}

TEST(RoundsTest, ARequestToStopDoesNotWaitForTheRoundUnderWay) {
  std::latch under_way(1);
  std::latch requested(1);
  std::atomic<int> count = 0;
  Rounds rounds("noted", [&](const auto&) -> Next {
    ++count;
    under_way.count_down();
    requested.wait();
    return {};
  });
  rounds.Start();
  under_way.wait();
  rounds.RequestStop();
  requested.count_down();
  rounds.Stop();
  EXPECT_EQ(count, 1);
}

TEST(RoundsTest, AStopBeforeTheStartDoesNothing) {
  NotedRounds noted({});
  Rounds rounds("noted", [&](const auto&) { return noted(); });
  rounds.Wake();
  rounds.RequestStop();
  rounds.Stop();
  EXPECT_TRUE(noted.begun().empty());
}

}  // namespace
}  // namespace uplink::loop
