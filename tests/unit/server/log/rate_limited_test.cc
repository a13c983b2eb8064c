#include "server/log/rate_limited.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"
#include "tests/unit/server/log/line_recorder.h"

namespace uplink::log {
namespace {

using ::testing::EndsWith;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::uplink::log::testing::RecordedLog;
using ::uplink::testing::ManualClock;

class RateLimitedTest : public ::testing::Test {
 protected:
  void WriteTimes(int times) {
    for (int i = 0; i < times; ++i) {
      limited_.Write(Level::kWarn, "bad_peer", {{"n", i}});
    }
  }

  ManualClock clock_;
  RecordedLog log_{clock_, Format::kText, Level::kInfo};
  RateLimited limited_{log_.logger, 3, milliseconds(1000)};
};

TEST_F(RateLimitedTest, WritesAllUpToTheBound) {
  WriteTimes(3);
  EXPECT_THAT(log_.lines, SizeIs(3));
  EXPECT_EQ(limited_.suppressed_total(), 0U);
}

TEST_F(RateLimitedTest, KeepsBackWhatIsPastTheBound) {
  WriteTimes(5);
  EXPECT_THAT(log_.lines, SizeIs(3));
  EXPECT_EQ(limited_.suppressed_total(), 2U);
}

TEST_F(RateLimitedTest, StaysSilentUntilTheSpanIsOver) {
  WriteTimes(4);
  clock_.Advance(milliseconds(999));
  WriteTimes(1);
  EXPECT_THAT(log_.lines, SizeIs(3));
  clock_.Advance(milliseconds(1));
  WriteTimes(1);
  EXPECT_THAT(log_.lines, SizeIs(4));
}

TEST_F(RateLimitedTest, SaysOnceHowManyWereKeptBack) {
  WriteTimes(7);
  clock_.Advance(milliseconds(1000));
  WriteTimes(2);
  ASSERT_THAT(log_.lines, SizeIs(5));
  EXPECT_THAT(log_.lines[3], EndsWith("n=0 suppressed=4"));
  EXPECT_THAT(log_.lines[4], EndsWith("n=1"));
}

TEST_F(RateLimitedTest, DoesNotCountWhatTheLevelKeepsBack) {
  for (int i = 0; i < 10; ++i) {
    limited_.Write(Level::kDebug, "d", {});
  }
  EXPECT_THAT(log_.lines, IsEmpty());
  EXPECT_EQ(limited_.suppressed_total(), 0U);
}

}  // namespace
}  // namespace uplink::log
