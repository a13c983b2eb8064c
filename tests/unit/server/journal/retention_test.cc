#include "server/journal/retention.h"

#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using testing::FailAt;

class RetentionTest : public ::testing::Test, protected StepBench {
 protected:
  void StoreFaults(std::size_t count) {
    RecordingClient robot("rcan://a");
    Hold(robot);
    storage::Batch batch;
    for (std::size_t i = 1; i <= count; ++i) {
      batch.records.push_back(RecordOf(robot, i));
      batch.records.back().held_since = 1;
      batch.records.back().received_at = clock.System();
    }
    ASSERT_TRUE(store.Commit(batch).ok());
    clock.Advance(std::chrono::days(91));
  }

  Retention retention_{context(), clock.Steady()};
};

TEST_F(RetentionTest, CountsWhatWentAndIsDueAfterItsInterval) {
  StoreFaults(2);
  EXPECT_TRUE(retention_.duty().IsDue(clock.Steady()));
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_EQ(probe.history_deleted.value(), 2);
  EXPECT_EQ(retention_.duty().due(), clock.Steady() + kRetainInterval);
}

TEST_F(RetentionTest, CountsTheRejectsThatAreKept) {
  RecordingClient robot("rcan://a");
  Hold(robot);
  storage::Batch batch;
  for (model::Seq seq = 1; seq <= 3; ++seq) {
    batch.records.push_back(RecordOf(robot, seq));
    batch.records.back().held_since = 1;
    batch.records.back().received_at = clock.System();
    if (seq < 3) {
      batch.records.back().content =
          storage::QuarantineItem{{model::RejectReason::kMalformed, "f", "d"}};
    }
  }
  ASSERT_TRUE(store.Commit(batch).ok());
  clock.Advance(std::chrono::days(15));
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_EQ(probe.history_deleted.value(), 2);
  EXPECT_EQ(probe.rejects_kept.value(), 2);
}

TEST_F(RetentionTest, IsDueAgainSoonWhereMoreIsLeft) {
  StoreFaults(storage::kRetainRowsMax + 1);
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_EQ(retention_.duty().due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_EQ(retention_.duty().due(), clock.Steady() + kRetainInterval);
}

TEST_F(RetentionTest, WhileTheStoreIsAwayItIsTheStoresErrorAndIsTriedAgainSoon) {
  store.FailNextRetains(1, FailAt::kBefore);
  EXPECT_EQ(retention_.Do(), Step::kFailed);
  EXPECT_TRUE(absl::IsUnavailable(errors.last()));
  EXPECT_TRUE(retain_error.last().ok());
  EXPECT_EQ(retention_.duty().due(), clock.Steady() + kRetainAgain);
}

TEST_F(RetentionTest, AnyOtherErrorIsItsOwnUntilItWorks) {
  store.FailNextRetains(1, FailAt::kBefore, absl::FailedPreconditionError("the clocks differ"));
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_TRUE(errors.last().ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(retain_error.last()));
  EXPECT_EQ(probe.retention_failing.value(), 1);
  EXPECT_EQ(retention_.duty().due(), clock.Steady() + kRetainLater);
  store.FailNextRetains(1, FailAt::kBefore);
  EXPECT_EQ(retention_.Do(), Step::kFailed);
  EXPECT_EQ(probe.retention_failing.value(), 1) << "that the store is away says nothing of it";
  EXPECT_EQ(retention_.Do(), Step::kWorked);
  EXPECT_TRUE(retain_error.last().ok());
  EXPECT_EQ(probe.retention_failing.value(), 0);
}

}  // namespace
}  // namespace uplink::journal
