#include "server/journal/duty.h"

#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};

TEST(DutyTest, IsDueFromItsTimeOn) {
  Duty duty(kNow);
  EXPECT_FALSE(duty.IsDue(kNow - milliseconds(1)));
  EXPECT_TRUE(duty.IsDue(kNow));
  EXPECT_TRUE(duty.IsDue(kNow + milliseconds(1)));
  duty.DueAt(kNow + milliseconds(5));
  EXPECT_EQ(duty.due(), kNow + milliseconds(5));
  EXPECT_FALSE(duty.IsDue(kNow));
}

TEST(DutyTest, OneThatAJournalDoesNotHaveIsNeverDue) {
  const Duty duty(Duty::kNever);
  EXPECT_FALSE(duty.IsDue(kNow + std::chrono::years(100)));
}

}  // namespace
}  // namespace uplink::journal
