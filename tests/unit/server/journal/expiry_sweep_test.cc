#include "server/journal/expiry_sweep.h"

#include <gtest/gtest.h>

#include "tests/unit/schema/samples.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using testing::FailAt;

class ExpirySweepTest : public ::testing::Test, protected StepBench {
 protected:
  /// Shapes that have expired long ago.
  void StoreShapes(std::size_t count) {
    Hold(robot_);
    storage::Batch batch;
    for (std::size_t i = 1; i <= count; ++i) {
      model::ReportedShape shape = test::SampleShape();
      shape.identity.id = std::to_string(i);
      shape.expire_time_ms = UnixMs(clock.System()) + 1;
      batch.records.push_back({.robot = robot_.robot(),
                               .seq = i,
                               .held_since = 1,
                               .received_at = clock.System(),
                               .content = test::RecordOf(model::ShapeOp{shape})});
    }
    ASSERT_TRUE(store.Commit(batch).ok());
    clock.Advance(storage::kExpiredKept + milliseconds(1));
  }

  /// Open runs that were not reported for too long.
  void StoreRuns(std::size_t count) {
    Hold(robot_);
    storage::Batch batch;
    for (std::size_t i = 1; i <= count; ++i) {
      model::MissionRunStatus report = test::SampleMission();
      report.run_id = std::to_string(i);
      report.status = model::MissionStatus::kRunning;
      batch.records.push_back({.robot = robot_.robot(),
                               .seq = i,
                               .held_since = 1,
                               .received_at = clock.System(),
                               .content = test::RecordOf(report)});
    }
    ASSERT_TRUE(store.Commit(batch).ok());
    clock.Advance(storage::kOpenRunAgeMax + milliseconds(1));
  }

  RecordingClient robot_{"rcan://a"};
  ExpirySweep sweep_{context(), clock.Steady()};
};

TEST_F(ExpirySweepTest, CountsWhatWentAndIsDueAfterItsInterval) {
  StoreShapes(2);
  EXPECT_TRUE(sweep_.duty().IsDue(clock.Steady()));
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(probe.expired_deleted.value(), 2);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepInterval);
}

TEST_F(ExpirySweepTest, IsDueAgainSoonWhereMoreIsLeft) {
  StoreShapes(storage::kSweepRowsMax + 1);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepInterval);
  EXPECT_EQ(probe.expired_deleted.value(), static_cast<std::int64_t>(storage::kSweepRowsMax) + 1);
}

TEST_F(ExpirySweepTest, IsDueAgainSoonWhereMoreChangesAreLeft) {
  for (std::size_t i = 0; i < storage::kChangesKept + storage::kChangesSweptMax + 1; ++i) {
    database.NoteChange({storage::PresentKind::kObject, "rcan://a", "i"});
  }
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepInterval);
  EXPECT_EQ(probe.expired_deleted.value(), 0);
}

TEST_F(ExpirySweepTest, ClosesRunsThatWereLeftOpenForTooLong) {
  StoreRuns(storage::kOpenRunsPerRobotMax);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(probe.runs_closed_for_age.value(),
            static_cast<std::int64_t>(storage::kOpenRunsPerRobotMax));
  EXPECT_EQ(probe.expired_deleted.value(), 0);
  static_assert(storage::kOpenRunsPerRobotMax >= storage::kSweepRowsMax);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepInterval);
}

TEST_F(ExpirySweepTest, AFailureIsTheStoresAndWaitsForTheNextTime) {
  store.FailNextSweeps(1, FailAt::kBefore);
  EXPECT_EQ(sweep_.Do(), Step::kFailed);
  EXPECT_TRUE(absl::IsUnavailable(errors.last()));
  EXPECT_EQ(sweep_.duty().due(), clock.Steady() + kSweepInterval);
  EXPECT_EQ(sweep_.Do(), Step::kWorked);
  EXPECT_TRUE(errors.last().ok());
}

}  // namespace
}  // namespace uplink::journal
