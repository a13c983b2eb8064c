#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/present_contract.h"

/// The bound of shapes and objects per robot.
namespace uplink::testing {
namespace {

using storage::Outcome;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class BoundContract : public PresentContract {
 protected:
  /// Rows "0", "1", ... up to `count`; those before `short_lived` expire at Time(1'000).
  void Fill(const PresentKind& kind, std::size_t count, std::size_t short_lived = 0) {
    std::vector<storage::CommitRecord> records;
    for (std::size_t i = 0; i < count; ++i) {
      records.push_back(Upsert(kind, std::to_string(i), 0, i < short_lived ? 1'000 : kLongMs));
    }
    EXPECT_THAT(Commit(std::move(records)), Each(OutcomeKind::kStored));
  }
};

TEST_P(BoundContract, RefusesOneMoreThanTheBound) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max - 1);
    storage::Batch batch;
    batch.records = {Upsert(kind, "last", 1), Upsert(kind, "more", 2), Upsert(kind, "0", 3),
                     Delete(kind, "unknown"), Delete(kind, "1"),       Upsert(kind, "more", 4),
                     Upsert(kind, "1", 5)};
    const model::Seq refused = numbers_ - 5;
    const std::vector<Outcome> outcomes = Commit(batch);
    ASSERT_THAT(outcomes, SizeIs(7));
    EXPECT_EQ(outcomes[0].kind, OutcomeKind::kStored) << "at the bound";
    ASSERT_EQ(outcomes[1].kind, OutcomeKind::kRefused);
    EXPECT_EQ(outcomes[1].rejection, kind.too_many());
    EXPECT_EQ(outcomes[2].kind, OutcomeKind::kStored) << "replaces";
    EXPECT_EQ(outcomes[3].kind, OutcomeKind::kStored) << "a delete";
    EXPECT_EQ(outcomes[4].kind, OutcomeKind::kStored) << "a delete that makes room";
    EXPECT_EQ(outcomes[5].kind, OutcomeKind::kStored) << "in that room";
    EXPECT_EQ(outcomes[6].kind, OutcomeKind::kRefused) << "its own place was taken";
    EXPECT_EQ(Count(kind), kind.per_robot_max);

    const auto quarantine = Quarantine();
    ASSERT_THAT(quarantine, SizeIs(2));
    EXPECT_EQ(quarantine[1].seq, refused);
    EXPECT_EQ(quarantine[1].rejection, kind.too_many());
    EXPECT_EQ(quarantine[1].payload, "bytes");

    const std::vector<Outcome> again = Commit(batch);
    ASSERT_THAT(again, SizeIs(7));
    EXPECT_EQ(again[0].kind, OutcomeKind::kDuplicate);
    ASSERT_EQ(again[1].kind, OutcomeKind::kRefused);
    EXPECT_EQ(again[1].rejection, kind.too_many());
    EXPECT_EQ(again[6].kind, OutcomeKind::kRefused);
    EXPECT_THAT(Quarantine(), SizeIs(2));
    const auto rejects = Open().rejects;
    ASSERT_THAT(rejects, SizeIs(2));
    EXPECT_EQ(rejects[0].seq, refused);
    EXPECT_EQ(rejects[0].rejection, kind.too_many());
  });
}

TEST_P(BoundContract, IsARobotsOwnAndAKindsOwn) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max);
    std::vector<storage::CommitRecord> records = {Of(Robot("b"), Upsert(kind, "more", 1))};
    for (const PresentKind& other : PresentKinds()) {
      if (other.name != std::string(kind.name)) records.push_back(Upsert(other, "more", 1));
    }
    records.push_back(Good(++numbers_, Fault("f")));
    records.push_back(Upsert(kind, "more", 1));
    EXPECT_THAT(Commit(std::move(records)),
                ElementsAre(OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kStored,
                            OutcomeKind::kRefused));
  });
}

TEST_P(BoundContract, GivesThePlacesOfExpiredOnesAway) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max, 3);
    Commit({Of(Robot("b"), Upsert(kind, "b's", 0, 1'000))});
    EXPECT_THAT(Commit({Upsert(kind, "too early", 999)}), ElementsAre(OutcomeKind::kRefused));
    EXPECT_EQ(Count(kind), kind.per_robot_max + 1);
    EXPECT_THAT(Commit({Upsert(kind, "n1", 1'000), Upsert(kind, "n2", 1'000),
                        Upsert(kind, "n3", 1'000), Upsert(kind, "n4", 1'000)}),
                ElementsAre(OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kStored,
                            OutcomeKind::kRefused));
    EXPECT_EQ(Count(kind), kind.per_robot_max + 1) << "another robot's expired row stays";
    EXPECT_THAT(Ids(kind, 1'000).at(0), "n3");
  });
}

TEST_P(BoundContract, GivesNoPlaceAwayByAClockThatNobodyVouchesFor) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max, 3);
    trust_.Set(false);
    EXPECT_THAT(Commit({Upsert(kind, "more", 1'000)}), ElementsAre(OutcomeKind::kRefused));
    EXPECT_EQ(Count(kind), kind.per_robot_max);
    EXPECT_THAT(Commit({Upsert(kind, "0", 1'000)}), ElementsAre(OutcomeKind::kStored))
        << "an update always passes";
    EXPECT_EQ(Count(kind), kind.per_robot_max);
    trust_.Set(true);
    EXPECT_THAT(Commit({Upsert(kind, "more", 1'000)}), ElementsAre(OutcomeKind::kStored));
  });
}

TEST_P(BoundContract, LeavesExpiredOnesBelowTheBound) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "old", 0, 1'000), Upsert(kind, "new", 2'000)});
    EXPECT_THAT(Ids(kind, 2'000, true), ElementsAre("new", "old"));
  });
}

TEST_P(BoundContract, CountsAnIdThatHasExpiredAsItsOwnPlace) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max, 1);
    EXPECT_THAT(Commit({Upsert(kind, "0", 1'000)}), ElementsAre(OutcomeKind::kStored));
    EXPECT_EQ(Count(kind), kind.per_robot_max);
    EXPECT_EQ(Ids(kind, 1'000).at(0), "0");
    EXPECT_THAT(Commit({Upsert(kind, "more", 1'000)}), ElementsAre(OutcomeKind::kRefused));
  });
}

TEST_P(BoundContract, CountsWhatAFailedCommitTookBack) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max - 1);
    storage::Batch batch;
    batch.records = {Upsert(kind, "last", 1)};
    store_->FailNextWrite(kProcess);
    EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
    EXPECT_EQ(Count(kind), kind.per_robot_max - 1);
    EXPECT_EQ(Commit(batch).at(0).kind, OutcomeKind::kStored);
    EXPECT_THAT(Commit({Upsert(kind, "more", 1)}), ElementsAre(OutcomeKind::kRefused));
    EXPECT_THAT(Commit({Of(robot_, Delete(kind, "last")), Upsert(kind, "more", 1)}),
                Each(OutcomeKind::kStored));
  });
}

TEST_P(BoundContract, HasRoomAgainAfterASweep) {
  ForEachKind([this](const PresentKind& kind) {
    Fill(kind, kind.per_robot_max, 1);
    EXPECT_EQ(store_->Process(kProcess).Sweep(Time(1'000) + storage::kExpiredKept)->items, 1U);
    // Its own clock says that nothing has expired: the room is the swept row's.
    EXPECT_THAT(Commit({Upsert(kind, "new", 5), Upsert(kind, "more", 5)}),
                ElementsAre(OutcomeKind::kStored, OutcomeKind::kRefused));
    EXPECT_THAT(Ids(kind, 5), ::testing::Not(IsEmpty()));
  });
}

INSTANTIATE_TEST_SUITE_P(Stores, BoundContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
