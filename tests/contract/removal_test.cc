#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

/// Robots that leave a store for good, and what is said about it, of stores that last.
namespace uplink::testing {
namespace {

using storage::ForgetAnswer;
using storage::TableCount;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;

class RemovalContract : public StoreContract {
 protected:
  storage::RobotRemoval& Removal() { return *store_->removal(); }
  template <typename T>
  static T ValueOf(absl::StatusOr<T> value) {
    EXPECT_TRUE(value.ok()) << value.status();
    return value.ok() ? *std::move(value) : T();
  }
  std::vector<TableCount> Count(const storage::RobotRef& robot) {
    return ValueOf(Removal().Count(robot->ruri));
  }
  storage::Epoch EpochNow() {
    const auto hold = ValueOf(Removal().HoldOf(robot_->ruri));
    return hold ? hold->epoch : 0;
  }
  bool Remove(storage::Epoch epoch) { return ValueOf(Removal().Remove(robot_->ruri, epoch)); }
  std::size_t RemoveHistories() {
    std::size_t removed = 0;
    while (const std::size_t some = ValueOf(Removal().RemoveHistories(robot_->ruri))) {
      removed += some;
    }
    return removed;
  }
  std::vector<std::string> SilentSince(std::int64_t until_ms, std::string_view after = {}) {
    std::vector<std::string> names;
    for (const storage::SilentRobot& robot :
         ValueOf(Removal().SilentSince(Time(until_ms), storage::ProcessId{kProcess}, after))) {
      names.push_back(robot.ruri);
    }
    return names;
  }
  static model::MissionRunStatus Report() {
    model::MissionRunStatus report;
    report.mission_id = "m";
    report.run_id = "r";
    report.status = model::MissionStatus::kRunning;
    return report;
  }
  /// Rows of several tables: of what is present, and of histories.
  void Fill() {
    Commit({Good(1, Fault("f")), Good(2), Good(3, Report()), Bad(4), Good(5)});
    storage::Batch batch;
    batch.presence_session = model::SessionId({0xEE});
    batch.presence = {{robot_, model::Presence::kOnline, Time(), ++presence_, held_since_}};
    batch.gaps = {Gap(7, 8)};
    Commit(batch);
  }

  model::Seq presence_ = 0;
};

TEST_P(RemovalContract, TakesAllThatARobotIsAndHas) {
  Fresh();
  Fill();
  const storage::RobotRef other = Robot("b");
  storage::OpenRequest request = Request();
  request.robot = other;
  const storage::Epoch mine = held_since_;
  ASSERT_TRUE(store_->Process(kProcess).OpenStreams(std::span(&request, 1)).ok());
  const std::vector<TableCount> others = Count(other);
  EXPECT_THAT(Count(robot_),
              ElementsAre(TableCount{"robots", 1}, TableCount{"sessions", 1},
                          TableCount{"faults_active", 1}, TableCount{"mission_runs", 1},
                          TableCount{"presence_latest", 1}, TableCount{"gaps", 1},
                          TableCount{"faults_history", 1}, TableCount{"messages", 2},
                          TableCount{"mission_reports", 1}, TableCount{"presence_changes", 1},
                          TableCount{"quarantine", 1}));
  held_since_ = mine;
  EXPECT_TRUE(Remove(EpochNow()));
  EXPECT_THAT(Count(robot_),
              ElementsAre(TableCount{"faults_history", 1}, TableCount{"messages", 2},
                          TableCount{"mission_reports", 1}, TableCount{"presence_changes", 1},
                          TableCount{"quarantine", 1}));
  EXPECT_EQ(RemoveHistories(), 6U);
  EXPECT_THAT(Count(robot_), IsEmpty());
  EXPECT_EQ(Count(other), others);
}

TEST_P(RemovalContract, LeavesARobotThatSpokeMeanwhile) {
  Fresh();
  Fill();
  const std::vector<TableCount> before = Count(robot_);
  const storage::Epoch asked = EpochNow();
  Open();
  EXPECT_GT(EpochNow(), asked);
  EXPECT_FALSE(Remove(asked));
  EXPECT_FALSE(Remove(0)) << "it has a row";
  EXPECT_EQ(Count(robot_), before);
}

TEST_P(RemovalContract, LeavesWhatWasWrittenAfterwards) {
  Fresh();
  Fill();
  ASSERT_TRUE(Remove(EpochNow()));
  EXPECT_EQ(Open().cursor, 0U) << "its session is gone as well";
  Commit({Good(1), Good(2)});
  EXPECT_EQ(RemoveHistories(), 6U);
  EXPECT_THAT(Messages(), SizeIs(2));
  EXPECT_EQ(CursorNow(), 2U);
}

TEST_P(RemovalContract, WhoHeldTheRobotIsFencedFromThenOn) {
  Fresh();
  const storage::Epoch before = held_since_;
  ASSERT_TRUE(Remove(EpochNow()));
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(storage::OutcomeKind::kFenced)) << "there is no row";
  EXPECT_EQ(EpochNow(), 0U) << "and a batch makes none";
  EXPECT_GT(Open(Request(), kOther).held_since, before) << "epochs never come again";
  held_since_ = before;
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(storage::OutcomeKind::kFenced)) << "another's now";
  EXPECT_THAT(Messages(), IsEmpty());
}

TEST_P(RemovalContract, FinishesWhatWasLeftWithoutARow) {
  Fresh();
  Fill();
  ASSERT_TRUE(Remove(EpochNow()));
  EXPECT_EQ(EpochNow(), 0U);
  store_->Reopen();  // whoever removed it was ended before the histories
  EXPECT_FALSE(Remove(1)) << "it has no row";
  EXPECT_TRUE(Remove(0));
  EXPECT_EQ(EpochNow(), 0U) << "no row was left behind";
  EXPECT_EQ(RemoveHistories(), 6U);
  EXPECT_THAT(Count(robot_), IsEmpty());
}

TEST_P(RemovalContract, NamesRobotsOfWhichNothingWasHeard) {
  Fresh();
  EXPECT_THAT(SilentSince(0), IsEmpty()) << "heard at that moment";
  EXPECT_THAT(SilentSince(1), ElementsAre(robot_->ruri));
  Commit({At(kDayMs, Good(1))});
  EXPECT_THAT(SilentSince(kDayMs), IsEmpty()) << "a session of it was used since";
  EXPECT_THAT(SilentSince(kDayMs + 1), ElementsAre(robot_->ruri));
  storage::Batch batch;
  batch.presence_session = model::SessionId({0xEE});
  batch.presence = {{robot_, model::Presence::kOnline, Time(2 * kDayMs), 1, held_since_}};
  Commit(batch);
  EXPECT_THAT(SilentSince(2 * kDayMs), IsEmpty()) << "its presence changed since";
  EXPECT_THAT(SilentSince(2 * kDayMs + 1), ElementsAre(robot_->ruri));
}

TEST_P(RemovalContract, DoesNotCallARobotSilentThatALivingProcessHolds) {
  Fresh();
  storage::Leases* const leases = store_->LeasesOf(kOther);
  if (leases == nullptr) GTEST_SKIP() << "one process at a time";
  ASSERT_TRUE(leases->Renew({.name = "b", .life = "2"}).ok());
  Open(Request(), kOther);
  EXPECT_THAT(SilentSince(kDayMs), IsEmpty());
  ASSERT_TRUE(leases->Release().ok());
  EXPECT_THAT(SilentSince(kDayMs), ElementsAre(robot_->ruri));
}

TEST_P(RemovalContract, PassesARequestOnAndItsAnswerBack) {
  Fresh();
  EXPECT_THAT(ValueOf(Removal().Pending()), IsEmpty());
  const std::uint64_t number = ValueOf(Removal().Ask(robot_->ruri, true));
  EXPECT_EQ(ValueOf(Removal().AnswerTo(number)).answer, ForgetAnswer::kNone);
  auto pending = ValueOf(Removal().Pending());
  ASSERT_THAT(pending, SizeIs(1));
  EXPECT_EQ(pending[0].number, number);
  EXPECT_EQ(pending[0].ruri, robot_->ruri);
  EXPECT_TRUE(pending[0].end_stream);
  EXPECT_FALSE(pending[0].finished);
  ASSERT_TRUE(pending[0].hold.has_value());
  EXPECT_EQ(pending[0].hold->owner, storage::ProcessId{kProcess});
  EXPECT_EQ(pending[0].hold->epoch, EpochNow());

  ASSERT_TRUE(Removal().Answer(number, {ForgetAnswer::kLetGo, 42}).ok());
  ASSERT_TRUE(Removal().Answer(number, {ForgetAnswer::kHasStream, 0}).ok());
  const storage::AnsweredForget answer = ValueOf(Removal().AnswerTo(number));
  EXPECT_EQ(answer.answer, ForgetAnswer::kLetGo) << "the first answer stands";
  EXPECT_EQ(answer.epoch, 42U);
  EXPECT_THAT(ValueOf(Removal().Pending()), IsEmpty());

  ASSERT_TRUE(Remove(EpochNow()));
  ASSERT_TRUE(Removal().Finish(number).ok());
  pending = ValueOf(Removal().Pending());
  ASSERT_THAT(pending, SizeIs(1)) << "the others learn of it";
  EXPECT_TRUE(pending[0].finished);
  EXPECT_FALSE(pending[0].hold.has_value());
}

TEST_P(RemovalContract, TakesNoAnswerToARequestThatWasGivenUp) {
  Fresh();
  const std::uint64_t number = ValueOf(Removal().Ask(robot_->ruri, false));
  ASSERT_TRUE(Removal().Finish(number).ok());
  ASSERT_TRUE(Removal().Answer(number, {ForgetAnswer::kLetGo, 1}).ok());
  EXPECT_EQ(ValueOf(Removal().AnswerTo(number)).answer, ForgetAnswer::kNone);
}

INSTANTIATE_TEST_SUITE_P(Stores, RemovalContract, ::testing::Values(SqliteKind(), PostgresKind()),
                         NameOfKind);

}  // namespace
}  // namespace uplink::testing
