#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST_P(StoreContract, RaisesAndClearsAFault) {
  Open();
  Commit({Good(1, Fault("f"))});
  const auto active = Active();
  ASSERT_THAT(active, SizeIs(1));
  EXPECT_EQ(active[0].fault, Fault("f"));
  EXPECT_EQ(active[0].raised_at, Time());
  Commit({Good(2, Cleared("f"))});
  EXPECT_THAT(Active(), SizeIs(0));
  const auto history = History();
  ASSERT_THAT(history, SizeIs(2));
  EXPECT_FALSE(history[0].fault.active);
  EXPECT_TRUE(history[1].fault.active);
}

TEST_P(StoreContract, KeepsTheFirstRaiseAndUpdatesTheRest) {
  Open();
  Commit({Good(1, Fault("f"))});
  model::Fault worse = Fault("f");
  worse.severity = model::FaultSeverity::kCritical;
  worse.description = "burning";
  storage::CommitRecord later = Good(2, worse);
  later.received_at = Time(50);
  later.robot = Robot("a", "f2");
  Commit({later});
  const auto active = Active();
  ASSERT_THAT(active, SizeIs(1));
  EXPECT_EQ(active[0].fault, worse);
  EXPECT_EQ(active[0].raised_at, Time());
  EXPECT_EQ(active[0].received_at, Time(50));
  EXPECT_EQ(History()[0].robot.fleet, "f2");
}

TEST_P(StoreContract, AnActiveFaultGoesWithItsRobotToAnotherFleet) {
  Open();
  Commit({Good(1, Fault("f"))});
  OpenAlso({Robot("a", "f2")});
  EXPECT_THAT(Active({.fleets = {"f1"}}), SizeIs(0));
  ASSERT_THAT(Active({.fleets = {"f2"}}), SizeIs(1));
  EXPECT_EQ(History()[0].robot.fleet, "f1") << "a history tells what was";
}

TEST_P(StoreContract, RaisesAnewAfterAClear) {
  Open();
  storage::CommitRecord raised_again = Good(3, Fault("f"));
  raised_again.received_at = Time(70);
  Commit({Good(1, Fault("f")), Good(2, Cleared("f")), raised_again});
  const auto active = Active();
  ASSERT_THAT(active, SizeIs(1));
  EXPECT_EQ(active[0].raised_at, Time(70));
  EXPECT_THAT(History(), SizeIs(3));
}

TEST_P(StoreContract, TakesAClearWithoutARaiseIntoTheHistoryAlone) {
  Open();
  EXPECT_THAT(Commit({Good(1, Cleared("f")), Good(2, Fault("f")), Good(3, Cleared("f")),
                      Good(4, Cleared("f"))}),
              Each(OutcomeKind::kStored));
  EXPECT_THAT(Active(), SizeIs(0));
  EXPECT_THAT(History(), SizeIs(4));
}

TEST_P(StoreContract, KeysActiveFaultsByRobotFaultAndSource) {
  Open();
  model::Fault other_source = Fault("f");
  other_source.source = "arm";
  model::Fault no_source = Fault("f");
  no_source.source = "";
  OpenAlso({Robot("b")});
  storage::CommitRecord other_robot = Good(1, Fault("f"));
  other_robot.robot = Robot("b");
  Commit({Good(1, Fault("f")), Good(2, other_source), Good(3, no_source), other_robot});
  EXPECT_THAT(Active(), SizeIs(4));
  Commit({Good(4, Cleared("f"))});
  EXPECT_THAT(Active(), SizeIs(3));

  const std::vector<std::string> ruris = {robot_->ruri, Robot("b")->ruri, Robot("none")->ruri};
  const auto counts = store_->reader().ActiveFaultCounts(ruris);
  ASSERT_TRUE(counts.ok()) << counts.status();
  std::int64_t sum = 0;
  for (const storage::ActiveFaults& count : *counts) {
    sum += count.count;
    EXPECT_EQ(count.count, count.ruri == robot_->ruri ? 2 : 1) << count.ruri;
  }
  EXPECT_EQ(sum, 3);
}

TEST_P(StoreContract, CountsActiveFaultsOfEveryNameInAnyOrder) {
  Open();
  const auto quoted = Robot("a\"b\\c");
  OpenAlso({Robot("b"), quoted});
  storage::CommitRecord of_b = Good(1, Fault("f"));
  of_b.robot = Robot("b");
  storage::CommitRecord of_quoted = Good(1, Fault("f"));
  of_quoted.robot = quoted;
  Commit({Good(1, Fault("f")), of_b, of_quoted});

  // Not all of them, and not sorted.
  const std::vector<std::string> ruris = {robot_->ruri, quoted->ruri};
  const auto counts = store_->reader().ActiveFaultCounts(ruris);
  ASSERT_TRUE(counts.ok()) << counts.status();
  std::vector<std::string> named;
  named.reserve(counts->size());
  for (const storage::ActiveFaults& count : *counts) {
    named.push_back(count.ruri);
    EXPECT_EQ(count.count, 1) << count.ruri;
  }
  EXPECT_THAT(named, ::testing::UnorderedElementsAre(quoted->ruri, robot_->ruri));
  EXPECT_TRUE(store_->reader().ActiveFaultCounts({}).ok());
}

TEST_P(StoreContract, CountsActiveFaultsBySeverity) {
  Open();
  model::Fault minor = Fault("minor");
  minor.severity = model::FaultSeverity::kMinor;
  model::Fault critical = Fault("critical");
  critical.severity = model::FaultSeverity::kCritical;
  model::Fault beyond = Fault("beyond");
  beyond.severity = static_cast<model::FaultSeverity>(77);
  model::Fault second = minor;
  second.fault_id = "second";
  Commit({Good(1, minor), Good(2, critical), Good(3, beyond), Good(4, second)});
  const std::vector<std::string> ruris = {robot_->ruri};
  const auto counts = store_->reader().ActiveFaultCounts(ruris);
  ASSERT_TRUE(counts.ok()) << counts.status();
  ASSERT_THAT(*counts, SizeIs(1));
  EXPECT_EQ(counts->front().count, 4);
  EXPECT_THAT(counts->front().by_severity, ::testing::ElementsAre(0, 2, 0, 1, 1));
}

TEST_P(StoreContract, BoundsTheActiveFaultsOfARobot) {
  Open();
  OpenAlso({Robot("b")});
  std::vector<storage::CommitRecord> raises;
  model::Seq seq = 0;
  for (std::size_t i = 1; i < storage::kActiveFaultsPerRobotMax; ++i) {
    raises.push_back(Good(++seq, Fault("f" + std::to_string(i))));
  }
  EXPECT_THAT(Commit(std::move(raises)), Each(OutcomeKind::kStored));
  const model::Seq at_bound = ++seq;
  const model::Seq past = ++seq;
  storage::Batch batch;
  batch.records = {Good(at_bound, Fault("last")), Good(past, Fault("more")),
                   Good(past + 1, Fault("f1")),   Good(past + 2, Cleared("unknown")),
                   Good(past + 3, Cleared("f2")), Good(past + 4, Fault("more"))};
  const auto outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(6));
  EXPECT_EQ(outcomes[0].kind, OutcomeKind::kStored);
  ASSERT_EQ(outcomes[1].kind, OutcomeKind::kRefused);
  EXPECT_EQ(outcomes[1].rejection->reason, model::RejectReason::kTooManyItems);
  EXPECT_EQ(outcomes[1].rejection->field, "faultId");
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kStored) << "an update of an active fault";
  EXPECT_EQ(outcomes[3].kind, OutcomeKind::kStored) << "a clear";
  EXPECT_EQ(outcomes[4].kind, OutcomeKind::kStored) << "a clear that makes room";
  EXPECT_EQ(outcomes[5].kind, OutcomeKind::kStored) << "a raise in that room";

  const auto quarantine = Quarantine();
  ASSERT_THAT(quarantine, SizeIs(1));
  EXPECT_EQ(quarantine[0].seq, past);
  EXPECT_EQ(quarantine[0].payload, "bytes");
  // The bound is the robot's own, and holds for the next batch too.
  storage::CommitRecord other_robot = Good(1, Fault("f"));
  other_robot.robot = Robot("b");
  EXPECT_THAT(Commit({other_robot, Good(past + 5, Fault("still more"))}),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kRefused));
}

TEST_P(StoreContract, SetsAsideWhatTheDatabaseRefusesAndKeepsTheRest) {
  Open();
  store_->RefuseFault("poison");
  storage::Batch batch;
  batch.records = {Good(1, Fault("f")), Good(2, Fault("poison")), Bad(3), Good(4, Cleared("f")),
                   Good(5, Fault("poison"))};
  batch.gaps = {Gap(6, 7)};
  const auto outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(5));
  EXPECT_EQ(outcomes[0].kind, OutcomeKind::kStored);
  ASSERT_EQ(outcomes[1].kind, OutcomeKind::kRefused);
  EXPECT_EQ(outcomes[1].rejection->reason, model::RejectReason::kStoreRefused);
  EXPECT_NE(outcomes[1].rejection->detail.find("the test says so"), std::string::npos);
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kStored);
  EXPECT_EQ(outcomes[3].kind, OutcomeKind::kStored);
  EXPECT_EQ(outcomes[4].kind, OutcomeKind::kRefused);
  EXPECT_THAT(History(), SizeIs(2)) << "nothing of a refused record is left";
  EXPECT_THAT(Active(), SizeIs(0));
  EXPECT_THAT(Gaps(), SizeIs(1));
  const auto quarantine = Quarantine();
  ASSERT_THAT(quarantine, SizeIs(3));
  EXPECT_EQ(quarantine[0].seq, 5);
  EXPECT_EQ(quarantine[2].seq, 2);
  EXPECT_EQ(quarantine[2].rejection, *outcomes[1].rejection);
  EXPECT_EQ(quarantine[2].payload, "bytes");
  EXPECT_EQ(CursorNow(), 5);
}

TEST_P(StoreContract, RefusesAgainWithTheSameReasonAfterALostAnswer) {
  Open();
  store_->RefuseFault("poison");
  storage::Batch batch;
  batch.records = {Good(1, Fault("f")), Good(2, Fault("poison")), Bad(3), Good(3)};
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  const auto again = Commit(batch);
  ASSERT_THAT(again, SizeIs(4));
  EXPECT_EQ(again[0].kind, OutcomeKind::kDuplicate);
  ASSERT_EQ(again[1].kind, OutcomeKind::kRefused);
  EXPECT_EQ(again[1].rejection->reason, model::RejectReason::kStoreRefused);
  ASSERT_EQ(again[2].kind, OutcomeKind::kRefused);
  EXPECT_EQ(*again[2].rejection, BadReason());
  ASSERT_EQ(again[3].kind, OutcomeKind::kRefused);
  EXPECT_EQ(*again[3].rejection, BadReason());
  EXPECT_THAT(Quarantine(), SizeIs(2));
}

}  // namespace
}  // namespace uplink::testing
