#include "server/run/deadline.h"

#include <future>

#include <gtest/gtest.h>

namespace uplink::run {
namespace {

TEST(Deadline, ActsOnceItHasPassed) {
  std::promise<void> acted;
  const Deadline deadline(milliseconds(1), [&] { acted.set_value(); });
  acted.get_future().wait();
}

TEST(Deadline, DoesNothingIfItGoesBefore) {
  bool acted = false;
  {
    const Deadline deadline(std::chrono::hours(1), [&] { acted = true; });
  }
  EXPECT_FALSE(acted);
}

}  // namespace
}  // namespace uplink::run
