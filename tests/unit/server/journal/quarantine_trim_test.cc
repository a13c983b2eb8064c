#include "server/journal/quarantine_trim.h"

#include <gtest/gtest.h>

#include "server/journal/journal.h"
#include "server/journal/limits.h"
#include "server/journal/turns.h"
#include "tests/unit/server/journal/journal_bench.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using testing::FailAt;

constexpr std::size_t kMax = storage::kQuarantineRowsPerRobotMax;

storage::CommitRecord BadOf(const RecordingClient& robot, model::Seq seq) {
  return {.robot = robot.robot(),
          .seq = seq,
          .held_since = 1,
          .content = storage::QuarantineItem{{model::RejectReason::kOutOfRange, "", ""}}};
}

class QuarantineTrimTest : public ::testing::Test, protected StepBench {
 protected:
  /// So many rows of a session that is settled, as its Hello says.
  void Quarantine(RecordingClient& robot, std::size_t rows) {
    Hold(robot);
    storage::Batch batch;
    for (std::size_t i = 1; i <= rows; ++i) batch.records.push_back(BadOf(robot, i));
    ASSERT_TRUE(store.Commit(batch).ok());
    storage::OpenRequest request = OpenOf(robot, 1).request;
    request.settled_seq = rows;
    ASSERT_TRUE(store.OpenStreams(std::vector{request}).ok());
  }
  [[nodiscard]] std::int64_t dropped() const {
    return probe.quarantine_dropped[static_cast<std::size_t>(model::RejectReason::kOutOfRange)]
        .value();
  }

  RecordingClient robot_{"rcan://a"};
  QuarantineTrim trim_{context()};
};

TEST_F(QuarantineTrimTest, IsDueOnlyWhileARobotIsNoted) {
  EXPECT_EQ(trim_.due(), Duty::kNever);
  quarantine.Note("rcan://a");
  EXPECT_EQ(trim_.due(), clock.Steady());
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(trim_.due(), Duty::kNever);
  quarantine.Note("rcan://b");
  EXPECT_EQ(trim_.due(), clock.Steady() + kTrimInterval);
}

TEST_F(QuarantineTrimTest, CountsWhatWentByReason) {
  Quarantine(robot_, kMax + 3);
  quarantine.Note("rcan://a");
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(dropped(), 3);
}

TEST_F(QuarantineTrimTest, GoesOnSoonWhereMoreIsLeft) {
  Quarantine(robot_, kMax + storage::kTrimRowsMax + 1);
  quarantine.Note("rcan://a");
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(dropped(), static_cast<std::int64_t>(storage::kTrimRowsMax));
  EXPECT_EQ(trim_.due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(dropped(), static_cast<std::int64_t>(storage::kTrimRowsMax) + 1);
  EXPECT_EQ(trim_.due(), Duty::kNever);
}

TEST_F(QuarantineTrimTest, LooksAtABoundedNumberOfRobotsPerCall) {
  for (std::size_t i = 0; i <= kTrimRobotsPerCall; ++i) quarantine.Note(std::to_string(i));
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(trim_.due(), clock.Steady() + kSweepAgain);
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_EQ(trim_.due(), Duty::kNever);
}

TEST_F(QuarantineTrimTest, AFailureIsTheStoresAndForgetsNoRobot) {
  Quarantine(robot_, kMax + 1);
  quarantine.Note("rcan://a");
  store.FailNextTrims(1, FailAt::kBefore);
  EXPECT_EQ(trim_.Do(), Step::kFailed);
  EXPECT_TRUE(absl::IsUnavailable(errors.last()));
  EXPECT_EQ(trim_.due(), clock.Steady() + kTrimInterval);
  EXPECT_EQ(trim_.Do(), Step::kWorked);
  EXPECT_TRUE(errors.last().ok());
  EXPECT_EQ(dropped(), 1);
}

TEST(QuarantineTurnTest, AJournalLooksAtRobotsWhoseRowsItCommitted) {
  JournalBench bench;
  RecordingClient good("rcan://good");
  bench.Open(good);
  bench.Append(good, 1);
  bench.Run();
  EXPECT_EQ(bench.store.trims(), 0U) << "a robot without bad messages costs nothing";
  RecordingClient bad("rcan://bad");
  bench.Open(bad);
  bench.journal.AppendMessage(bad, bad.generation(), {BadOf(bad, 1)}, bench.clock.Steady());
  bench.Run();
  EXPECT_EQ(bench.store.trims(), 1U);
  bench.journal.AppendMessage(bad, bad.generation(), {BadOf(bad, 2)}, bench.clock.Steady());
  bench.clock.Advance(kTrimInterval);
  bench.Run();
  EXPECT_EQ(bench.store.trims(), 1U) << "one row more is nothing to look at";
}

TEST(QuarantineTurnTest, ARefusalOfTheStoreIsNotedToo) {
  JournalBench bench;
  bench.store.SetRules({.refuse = [](const storage::CommitRecord& /*record*/) {
    return std::optional(model::Rejection{model::RejectReason::kStoreRefused, "", ""});
  }});
  RecordingClient robot("rcan://a");
  bench.Open(robot);
  bench.Append(robot, 1);
  bench.Run();
  EXPECT_EQ(bench.store.trims(), 1U);
}

}  // namespace
}  // namespace uplink::journal
