#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "metrics/cells.h"

namespace uplink::metrics {
namespace {

TEST(CoreCell, LosesNothingWhicheverCoreAThreadIsOn) {
  constexpr int kThreads = 4;
  constexpr int kTimes = 100'000;
  CoreCell cell;
  std::vector<std::jthread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int times = 0; times < kTimes; ++times) cell.Add(3);
    });
  }
  threads.clear();
  EXPECT_EQ(cell.value(), std::int64_t{3} * kThreads * kTimes);
}

}  // namespace
}  // namespace uplink::metrics
