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

TEST(DutyTest, ItsErrorIsThatOfTheLastTime) {
  Duty duty(kNow);
  EXPECT_TRUE(duty.error().ok());
  duty.NoteError(absl::InternalError("no such table"));
  EXPECT_EQ(duty.error(), absl::InternalError("no such table"));
  duty.NoteError(absl::OkStatus());
  EXPECT_TRUE(duty.error().ok());
}

TEST(DutyTest, AsLongAsItHasAnErrorItCountsOnce) {
  metrics::Cell failing;
  Duty duty(kNow, &failing);
  Duty other(kNow, &failing);
  duty.NoteError(absl::OkStatus());
  EXPECT_EQ(failing.value(), 0);
  duty.NoteError(absl::InternalError("a"));
  duty.NoteError(absl::InternalError("b"));
  EXPECT_EQ(failing.value(), 1);
  other.NoteError(absl::InternalError("a"));
  EXPECT_EQ(failing.value(), 2);
  duty.NoteError(absl::OkStatus());
  EXPECT_EQ(failing.value(), 1);
}

}  // namespace
}  // namespace uplink::journal
