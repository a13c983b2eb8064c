#include "server/limits/recent_times.h"

#include <chrono>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::limits {
namespace {

constexpr std::chrono::seconds kSpan{1};
constexpr SteadyTime kStart{};

TEST(RecentTimes, LetSoManyThroughInNoMoreThanASpan) {
  RecentTimes<10> times;
  std::vector<SteadyTime> passed;
  SteadyTime now = kStart;
  for (int i = 0; i < 3'000; ++i) {
    if (times.Take(now, kSpan)) passed.push_back(now);
    now += milliseconds(i % 7 == 0 ? 3 : 1);
  }
  for (std::size_t i = 10; i < passed.size(); ++i) EXPECT_GE(passed[i] - passed[i - 10], kSpan);
  EXPECT_GE(passed.size(), 30U);
}

TEST(RecentTimes, CountThoseThatAreLessThanASpanAgo) {
  struct Row {
    std::vector<int> noted_ms;
    int now_ms;
    std::size_t within;
    bool full;
  };
  for (const Row& row : std::vector<Row>{
           {{}, 0, 0, false},
           {{0}, 0, 1, false},
           {{0, 1}, 1, 2, false},
           {{0, 1, 2}, 999, 3, true},
           {{0, 1, 2}, 1'000, 2, false},
           {{0, 1, 2}, 1'002, 0, false},
           {{0, 1, 2, 3, 4}, 1'001, 3, true},
           {{0, 500, 1'000, 1'500}, 1'500, 2, false},
       }) {
    RecentTimes<3> times;
    for (const int at : row.noted_ms) times.Note(kStart + milliseconds(at));
    const SteadyTime now = kStart + milliseconds(row.now_ms);
    EXPECT_EQ(times.Within(now, kSpan), row.within) << row.noted_ms.size() << " " << row.now_ms;
    EXPECT_EQ(times.IsFull(now, kSpan), row.full) << row.noted_ms.size() << " " << row.now_ms;
  }
}

TEST(RecentTimes, OfOneAreOncePerSpan) {
  RecentTimes<1> times;
  EXPECT_TRUE(times.Take(kStart, kSpan)) << "the first one, whatever the time is";
  EXPECT_FALSE(times.Take(kStart + milliseconds(999), kSpan));
  EXPECT_TRUE(times.Take(kStart + milliseconds(1'000), kSpan));
}

}  // namespace
}  // namespace uplink::limits
