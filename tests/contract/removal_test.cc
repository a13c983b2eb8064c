#include <memory>
#include <utility>

#include <gmock/gmock.h>

#include "storage/kept_tables.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// Robots that leave a store for good, of stores that last.
namespace uplink::testing {
namespace {

using storage::TableCount;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

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
  bool Remove(storage::Epoch epoch) {
    const auto removed = ValueOf(Removal().Remove(robot_->ruri, epoch));
    bound_ = removed.value_or(bound_);
    return removed.has_value();
  }
  std::size_t RemoveHistories() {
    std::size_t removed = 0;
    while (const std::size_t some = ValueOf(Removal().RemoveHistories(robot_->ruri, bound_))) {
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
  /// As Fresh, without other robots.
  void FreshAlone() {
    store_ = nullptr;
    store_ = GetParam().make({});
    Open();
  }
  /// A row in each table.
  void Fill() {
    const model::ReportedShape shape = test::SampleShape();
    model::Object object = test::SampleObject();
    object.id = "o";
    Commit({Good(1, Fault("f")), Good(2), Good(3, Report()), Bad(4), Good(5),
            Good(6, model::EventTelemetry{}), Good(7, model::ShapeOp{shape}),
            Good(8, model::ObjectOp{object}), Good(9, model::AgentInfo{"a", "a", "a", 1}),
            Update(robot_, 10, {.id = "e", .detail_json = "{}"}), Limited(11, 12)});
    storage::Batch batch;
    batch.presence_session = model::SessionId({0xEE});
    batch.presence = {{robot_, model::Presence::kOnline, Time(), ++presence_, held_since_}};
    batch.gaps = {Gap(17, 18)};
    storage::ConnectionItem connection;
    connection.robot = robot_;
    batch.connections = {connection};
    Commit(batch);
    storage::LiveRow live;
    live.ruri = robot_->ruri;
    live.held_since = EpochNow();  // robots of Fresh have holds of their own
    live.last_sign_of_life = Time();
    EXPECT_TRUE(store_->Process(kProcess).Checkpoint({&live, 1}).ok());
    store_->NoteQuarantineDropped(robot_->ruri);
    const storage::ClaimRequest request{robot_, Time()};
    const auto claimed = store_->Process(kProcess).ClaimDrones({&request, 1});
    ASSERT_TRUE(claimed.ok()) << claimed.status();
    storage::CommitRecord asks = Good(13);
    asks.content = model::OperatorRequest{.request_id = "r", .open = true};
    asks.sample = std::make_shared<const storage::SampleMark>(
        storage::SampleMark{.claim = claimed->front().claim});
    Commit({asks});
  }
  static constexpr std::size_t kFilledHistories = 8;
  static std::vector<std::string_view> NamesOf(const std::vector<TableCount>& counts) {
    std::vector<std::string_view> names;
    names.reserve(counts.size());
    for (const TableCount& count : counts) names.push_back(count.table);
    return names;
  }
  static std::size_t SumOf(const std::vector<TableCount>& counts) {
    std::size_t rows = 0;
    for (const TableCount& count : counts) rows += count.rows;
    return rows;
  }

  model::Seq presence_ = 0;
  storage::EntryBound bound_{0};
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
  EXPECT_THAT(NamesOf(Count(robot_)), ElementsAreArray(storage::kKeptTables));
  EXPECT_THAT(Count(robot_), Contains(TableCount{"messages", 2}));
  held_since_ = mine;
  EXPECT_TRUE(Remove(EpochNow()));
  std::vector<std::string_view> histories;
  histories.reserve(storage::kHistoryTables.size());
  for (const storage::HistoryTable& table : storage::kHistoryTables)
    histories.push_back(table.name);
  EXPECT_THAT(NamesOf(Count(robot_)), ElementsAreArray(histories));
  EXPECT_EQ(SumOf(Count(robot_)), kFilledHistories);
  EXPECT_EQ(RemoveHistories(), kFilledHistories);
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
  EXPECT_EQ(RemoveHistories(), kFilledHistories);
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
  store_->Reopen();  // the process that removed it was ended before the histories
  EXPECT_FALSE(Remove(1)) << "it has no row";
  EXPECT_TRUE(Remove(0));
  EXPECT_EQ(EpochNow(), 0U) << "no row was left behind";
  EXPECT_EQ(RemoveHistories(), kFilledHistories);
  EXPECT_THAT(Count(robot_), IsEmpty());
}

TEST_P(RemovalContract, NamesRobotsOfWhichNothingWasHeard) {
  FreshAlone();
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
  FreshAlone();
  storage::Leases* const leases = store_->LeasesOf(kOther);
  if (leases == nullptr) {
    EXPECT_THAT(SilentSince(kDayMs), ElementsAre(robot_->ruri)) << "one process at a time";
    return;
  }
  ASSERT_TRUE(leases->Renew({.name = "b", .life = "2"}).ok());
  Open(Request(), kOther);
  EXPECT_THAT(SilentSince(kDayMs), IsEmpty());
  ASSERT_TRUE(leases->Release().ok());
  EXPECT_THAT(SilentSince(kDayMs), ElementsAre(robot_->ruri));
}

TEST_P(RemovalContract, NamesSoManySilentRobotsAtACall) {
  Fresh();
  std::vector<storage::RobotRef> robots;
  for (std::size_t i = 0; i < storage::kSilentRobotsMax; ++i) {
    robots.push_back(Robot("s" + std::to_string(1'000 + i)));
  }
  OpenAlso(robots);
  const std::vector<std::string> first = SilentSince(kDayMs);
  ASSERT_THAT(first, SizeIs(storage::kSilentRobotsMax));
  // b and c of Fresh, and its own.
  const std::vector<std::string> rest = SilentSince(kDayMs, first.back());
  EXPECT_THAT(rest, SizeIs(3));
  EXPECT_LT(first.back(), rest.front());
  EXPECT_THAT(SilentSince(kDayMs, rest.back()), IsEmpty());
}

TEST_P(RemovalContract, DeletesSoManyRowsOfAHistoryAtACall) {
  Fresh();
  constexpr std::size_t kMore = 10;
  storage::Batch batch;
  for (model::Seq seq = 1; seq <= storage::kRemovedPerCallMax + kMore; ++seq) {
    batch.records.push_back(At(static_cast<std::int64_t>(seq), Good(seq)));
    if (batch.records.size() == 1'000) Commit(std::exchange(batch, {}));
  }
  Commit(batch);
  ASSERT_TRUE(Remove(EpochNow()));
  EXPECT_EQ(ValueOf(Removal().RemoveHistories(robot_->ruri, bound_)), storage::kRemovedPerCallMax);
  EXPECT_EQ(ValueOf(Removal().RemoveHistories(robot_->ruri, bound_)), kMore);
  EXPECT_EQ(ValueOf(Removal().RemoveHistories(robot_->ruri, bound_)), 0U);
}

TEST_P(RemovalContract, TheBoundIsThatOfTheRemovalAndNotOfALaterOne) {
  Fresh();
  Fill();
  ASSERT_TRUE(Remove(EpochNow()));
  const storage::EntryBound bound = bound_;
  Open();
  Commit({Good(1), Good(2)});
  const storage::RobotRef other = Robot("b");
  const auto hold = ValueOf(Removal().HoldOf(other->ruri));
  ASSERT_TRUE(hold.has_value());
  ASSERT_TRUE(ValueOf(Removal().Remove(other->ruri, hold->epoch)).has_value());
  bound_ = bound;
  EXPECT_EQ(RemoveHistories(), kFilledHistories);
  EXPECT_THAT(Messages(), SizeIs(2));
}

TEST_P(RemovalContract, EachTableOfRobotsIsKnown) {
  std::vector<std::string> known(storage::kKeptTables.begin(), storage::kKeptTables.end());
  // What servers are asked goes by its age.
  known.emplace_back("forget_requests");
  // A block and a registration outlive their robot.
  known.emplace_back("robot_settings");
  EXPECT_THAT(store_->TablesOfRobots(), UnorderedElementsAreArray(known))
      << "a table with a column `ruri` has its row in storage/kept_tables.h";
}

INSTANTIATE_TEST_SUITE_P(Stores, RemovalContract, ::testing::Values(SqliteKind(), PostgresKind()),
                         NameOfKind);

}  // namespace
}  // namespace uplink::testing
