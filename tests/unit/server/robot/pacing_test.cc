#include "server/robot/pacing.h"

#include <string>

#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

TEST(PacingTest, APayloadPerReasonAndSecondIsKept) {
  const SteadyTime now = testing::ManualClock().Steady();
  Pacing pacing;
  EXPECT_TRUE(pacing.KeepPayload(model::RejectReason::kMalformed, now));
  EXPECT_TRUE(pacing.KeepPayload(model::RejectReason::kStoreRefused, now));
  EXPECT_FALSE(pacing.KeepPayload(model::RejectReason::kMalformed, now + milliseconds(999)));
  EXPECT_TRUE(pacing.KeepPayload(model::RejectReason::kMalformed, now + milliseconds(1000)));
}

TEST(PacingTest, IndexesOfAListShareOnePace) {
  const SteadyTime now = testing::ManualClock().Steady();
  Pacing pacing;
  EXPECT_TRUE(pacing.MayNotice("joints[0].effort", now));
  EXPECT_FALSE(pacing.MayNotice("joints[17].effort", now));
  EXPECT_TRUE(pacing.MayNotice("joints[0].velocity", now));
  EXPECT_TRUE(pacing.MayNotice("joints[17].effort", now + milliseconds(1000)));
}

TEST(PacingTest, FieldsPastTheBoundShareOneSlot) {
  const SteadyTime now = testing::ManualClock().Steady();
  Pacing pacing;
  for (std::size_t i = 0; i < kNoticeFieldsMax; ++i) {
    EXPECT_TRUE(pacing.MayNotice("field" + std::to_string(i), now));
  }
  EXPECT_TRUE(pacing.MayNotice("one more", now));
  EXPECT_FALSE(pacing.MayNotice("and another", now));
}

}  // namespace
}  // namespace uplink::robot
