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

TEST(DutyErrorTest, IsThatOfTheLastTime) {
  metrics::Cell failing;
  DutyError error(failing);
  EXPECT_TRUE(error.last().ok());
  error.Note(absl::InternalError("no such table"));
  EXPECT_EQ(error.last(), absl::InternalError("no such table"));
  error.Note(absl::OkStatus());
  EXPECT_TRUE(error.last().ok());
}

TEST(DutyErrorTest, AsLongAsThereIsOneItCountsOnce) {
  metrics::Cell failing;
  DutyError error(failing);
  DutyError other(failing);
  error.Note(absl::OkStatus());
  EXPECT_EQ(failing.value(), 0);
  error.Note(absl::InternalError("a"));
  error.Note(absl::InternalError("b"));
  EXPECT_EQ(failing.value(), 1);
  other.Note(absl::InternalError("a"));
  EXPECT_EQ(failing.value(), 2);
  error.Note(absl::OkStatus());
  EXPECT_EQ(failing.value(), 1);
}

}  // namespace
}  // namespace uplink::journal
