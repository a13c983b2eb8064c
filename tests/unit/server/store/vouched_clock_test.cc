#include "server/store/vouched_clock.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

class VouchedClockTest : public ::testing::Test {
 protected:
  void Note(bool vouched) { trust_.Note(vouched, ClockPair::Of(clock_)); }
  void Jump(milliseconds by) { clock_.SetSystem(clock_.System() + by); }

  testing::ManualClock clock_;
  VouchedClock trust_{clock_};
};

TEST_F(VouchedClockTest, NobodyVouchesBeforeTheFirstLook) {
  EXPECT_FALSE(trust_.vouched());
  Note(true);
  EXPECT_TRUE(trust_.vouched());
  Note(false);
  EXPECT_FALSE(trust_.vouched());
}

TEST_F(VouchedClockTest, AJumpAheadEndsTheJudgementAtOnce) {
  Note(true);
  clock_.Advance(std::chrono::hours(1));
  EXPECT_TRUE(trust_.vouched()) << "both clocks advanced";
  Jump(kAdvanceTolerance);
  EXPECT_TRUE(trust_.vouched());
  Jump(milliseconds(1));
  EXPECT_FALSE(trust_.vouched());
  Note(true);
  EXPECT_TRUE(trust_.vouched()) << "a look said so";
}

TEST_F(VouchedClockTest, AJumpBackLeavesIt) {
  Note(true);
  Jump(-std::chrono::days(100));
  EXPECT_TRUE(trust_.vouched()) << "less is deleted";
}

TEST_F(VouchedClockTest, VouchesForNoTimeThatIsStillToCome) {
  Note(true);
  EXPECT_TRUE(trust_.VouchesFor(clock_.System() - std::chrono::days(1)));
  EXPECT_TRUE(trust_.VouchesFor(clock_.System() + kAdvanceTolerance));
  EXPECT_FALSE(trust_.VouchesFor(clock_.System() + kAdvanceTolerance + milliseconds(1)))
      << "it was read during a jump that is over";
  Note(false);
  EXPECT_FALSE(trust_.VouchesFor(clock_.System()));
}

TEST_F(VouchedClockTest, TellsByHowMuchCivilTimeRanAhead) {
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(trust_.ahead(), milliseconds(0));
  Jump(std::chrono::seconds(90));
  EXPECT_EQ(trust_.ahead(), std::chrono::seconds(90));
  Jump(-std::chrono::seconds(100));
  EXPECT_EQ(trust_.ahead(), -std::chrono::seconds(10));
}

}  // namespace
}  // namespace uplink::store
