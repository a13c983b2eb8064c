#include "server/journal/duty_error.h"

#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

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
