#include <algorithm>
#include <map>

#include <gmock/gmock.h>

#include "schema/json/text.h"
#include "schema/limits.h"
#include "storage/bounds.h"
#include "tests/contract/store_contract.h"
#include "tests/support/fake_trust.h"
#include "tests/unit/schema/samples.h"

/// Shapes and objects of scope fleet or world, as a server reads them to forward them.
namespace uplink::testing {
namespace {

using model::ScopeType;
using storage::ChangePositions;
using storage::ItemKey;
using storage::OutcomeKind;
using storage::PresentKind;
using storage::SharedChanges;
using storage::SharedItem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

constexpr std::int64_t kKeptMs = milliseconds(storage::kExpiredKept).count();

class SharedItemsContract : public StoreContract {
 protected:
  storage::SharedItems& Items() { return store_->shared_items(); }
  template <typename T>
  static T ValueOf(absl::StatusOr<T> value) {
    EXPECT_TRUE(value.ok()) << value.status();
    return value.ok() ? *std::move(value) : T();
  }

  storage::CommitRecord Shape(const std::string& id, ScopeType scope = ScopeType::kFleet) {
    model::ReportedShape shape = test::SampleShape();
    shape.identity.id = id;
    shape.scope = scope;
    shape.expire_time_ms = 0;
    return Good(++numbers_, model::ShapeOp{shape});
  }
  /// Expires `expires_ms` after Time().
  storage::CommitRecord Object(const std::string& id, ScopeType scope = ScopeType::kFleet,
                               std::int64_t expires_ms = 1'000'000'000) {
    model::Object object = test::SampleObject();
    object.id = id;
    object.scope = scope;
    object.expires_unix_time_ms = kNowMs + expires_ms;
    return Good(++numbers_, model::ObjectOp{object});
  }
  storage::CommitRecord NoShape(const std::string& id) {
    return Good(++numbers_, model::ShapeOp{model::Deletion{id}});
  }
  storage::CommitRecord NoObject(const std::string& id) {
    return Good(++numbers_, model::ObjectOp{model::Deletion{id}});
  }
  static ItemKey ShapeKey(const std::string& id, const std::string& robot = "a") {
    return {PresentKind::kShape, "rcan://robots/" + robot, id};
  }
  static ItemKey ObjectKey(const std::string& id, const std::string& robot = "a") {
    return {PresentKind::kObject, "rcan://robots/" + robot, id};
  }

  std::vector<SharedItem> AllItems() {
    std::vector<SharedItem> all;
    std::optional<ItemKey> after;
    while (true) {
      storage::SharedPage page = ValueOf(Items().Page(after));
      EXPECT_LE(page.items.size(), storage::kSharedPageMax);
      for (SharedItem& item : page.items) all.push_back(std::move(item));
      ++pages_;
      if (!page.more) return all;
      after = all.back().Key();
    }
  }
  static std::vector<ItemKey> KeysOf(const std::vector<SharedItem>& items) {
    std::vector<ItemKey> keys;
    keys.reserve(items.size());
    for (const SharedItem& item : items) keys.push_back(item.Key());
    return keys;
  }
  std::vector<ItemKey> Present() { return KeysOf(AllItems()); }
  std::vector<ItemKey> Found(const std::vector<ItemKey>& keys) {
    return KeysOf(ValueOf(Items().Of(keys)));
  }

  /// From here on, the present state is read.
  void Begin() { positions_ = ValueOf(Items().Positions()); }
  /// One round of changes; they were not trimmed.
  std::vector<ItemKey> Changed() {
    SharedChanges changes = ValueOf(Items().ChangesSince(positions_));
    EXPECT_FALSE(changes.trimmed);
    EXPECT_FALSE(changes.more);
    positions_ = changes.positions;
    return std::move(changes.keys);
  }
  bool IsTrimmed() { return ValueOf(Items().ChangesSince(positions_)).trimmed; }
  /// All rounds until nothing more is there; how many.
  int SkipChanges() {
    for (int rounds = 1;; ++rounds) {
      SharedChanges changes = ValueOf(Items().ChangesSince(positions_));
      EXPECT_FALSE(changes.trimmed);
      positions_ = changes.positions;
      if (!changes.more) return rounds;
    }
  }
  /// An empty store that was not read yet.
  void FreshBegin(const storage::StoreRules& rules = {}) {
    Fresh(rules);
    Begin();
  }

  model::Seq numbers_ = 0;
  int pages_ = 0;
  ChangePositions positions_;
};

TEST_P(SharedItemsContract, UpsertsAndDeletesAreChanges) {
  FreshBegin();
  EXPECT_THAT(Changed(), IsEmpty());
  Commit({Shape("s"), Object("o"), Object("w", ScopeType::kWorld)});
  EXPECT_THAT(Changed(), UnorderedElementsAre(ShapeKey("s"), ObjectKey("o"), ObjectKey("w")));
  EXPECT_THAT(Changed(), IsEmpty()) << "each once";
  Commit({Shape("s")});
  EXPECT_THAT(Changed(), ElementsAre(ShapeKey("s"))) << "an update";
  EXPECT_THAT(Present(), ElementsAre(ShapeKey("s"), ObjectKey("o"), ObjectKey("w")));
  Commit({NoShape("s"), NoObject("o"), NoObject("never there")});
  EXPECT_THAT(Changed(), UnorderedElementsAre(ShapeKey("s"), ObjectKey("o")));
  EXPECT_THAT(Found({ShapeKey("s"), ObjectKey("o"), ObjectKey("w")}), ElementsAre(ObjectKey("w")));
  EXPECT_THAT(Present(), ElementsAre(ObjectKey("w")));
}

TEST_P(SharedItemsContract, ItemsHaveAllTheirFields) {
  FreshBegin();
  const model::ReportedShape shape = test::SampleShape();
  const model::Object object = test::SampleObject();
  Commit({Good(1, model::ShapeOp{shape}), Good(2, model::ObjectOp{object})});
  const std::vector<SharedItem> paged = AllItems();
  const std::vector<SharedItem> found = ValueOf(Items().Of(Changed()));
  for (const std::vector<SharedItem>& items : {paged, found}) {
    ASSERT_THAT(items, SizeIs(2));
    EXPECT_EQ(items[0].robot(), *robot_);
    EXPECT_EQ(items[0].expires_at_ms(), shape.expire_time_ms);
    const auto& one = std::get<storage::ShapeRow>(items[0].row);
    const storage::ShapeRow listed = Shapes(-1'000'000'000'000).at(0);
    EXPECT_EQ(one.identity, shape.identity);
    EXPECT_EQ(one.area_type, shape.area_type);
    EXPECT_EQ(one.scope, ScopeType::kFleet);
    EXPECT_EQ(one.geometry_json, listed.geometry_json);
    EXPECT_EQ(one.min_z_m, shape.min_z_m);
    EXPECT_EQ(one.max_z_m, shape.max_z_m);
    EXPECT_EQ(one.level_id, shape.level_id);
    EXPECT_EQ(one.received_at, Time());
    EXPECT_EQ(items[1].robot(), *robot_);
    EXPECT_EQ(items[1].expires_at_ms(), object.expires_unix_time_ms);
    const auto& other = std::get<storage::ObjectRow>(items[1].row);
    const storage::ObjectRow listed_object = Objects(-1'000'000'000'000).at(0);
    EXPECT_EQ(other.name, object.name);
    EXPECT_EQ(other.object_type, object.object_type);
    EXPECT_EQ(other.scope, ScopeType::kWorld);
    EXPECT_EQ(other.location_json, listed_object.location_json);
    EXPECT_EQ(other.trajectory_json, listed_object.trajectory_json);
    EXPECT_EQ(other.radius_m, object.radius_m);
    EXPECT_EQ(other.sampled_at_ms, object.unix_time_ms);
  }
}

TEST_P(SharedItemsContract, WhatIsForTheRobotOrAPersonAloneIsNoChange) {
  FreshBegin();
  Commit({Shape("s", ScopeType::kRobot), Object("o", ScopeType::kRobot),
          Object("u", ScopeType::kUser)});
  Commit({Shape("s", ScopeType::kUser), NoObject("o")});
  EXPECT_THAT(Changed(), IsEmpty());
  EXPECT_THAT(Present(), IsEmpty());
  EXPECT_THAT(Found({ShapeKey("s"), ObjectKey("u")}), IsEmpty());
}

TEST_P(SharedItemsContract, AnotherScopeIsAChangeIfOneOfTheTwoIsShared) {
  FreshBegin();
  Commit({Shape("s"), Object("o", ScopeType::kRobot)});
  EXPECT_THAT(Changed(), ElementsAre(ShapeKey("s")));
  Commit({Shape("s", ScopeType::kRobot), Object("o", ScopeType::kWorld)});
  EXPECT_THAT(Changed(), UnorderedElementsAre(ShapeKey("s"), ObjectKey("o")));
  EXPECT_THAT(Present(), ElementsAre(ObjectKey("o")));
  Commit({Shape("s", ScopeType::kUser)});
  EXPECT_THAT(Changed(), IsEmpty()) << "it was no longer shared";
}

TEST_P(SharedItemsContract, OneThatExpiredIsThereUntilItIsSwept) {
  FreshBegin();
  Commit({Object("o", ScopeType::kFleet, 1'000), Object("r", ScopeType::kRobot, 1'000)});
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("o")));
  storage::Store& store = store_->Process(kProcess);
  EXPECT_EQ(store.Sweep(Time(1'000))->items, 0U);
  EXPECT_THAT(Changed(), IsEmpty());
  EXPECT_THAT(Present(), ElementsAre(ObjectKey("o")));
  EXPECT_THAT(Found({ObjectKey("o")}), ElementsAre(ObjectKey("o")));
  EXPECT_EQ(store.Sweep(Time(1'000 + kKeptMs))->items, 2U);
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("o")));
  EXPECT_THAT(Present(), IsEmpty());
}

TEST_P(SharedItemsContract, WhatARobotTakesWithItIsAChange) {
  FreshBegin();
  Commit({Shape("s"), Object("o"), Object("r", ScopeType::kRobot),
          Of(Robot("b"), Object("of b", ScopeType::kFleet))});
  EXPECT_THAT(Changed(), SizeIs(3));
  store_->RemoveRobot(robot_->ruri);
  EXPECT_THAT(Changed(), UnorderedElementsAre(ShapeKey("s"), ObjectKey("o")));
  EXPECT_THAT(Present(), ElementsAre(ObjectKey("of b", "b")));
}

TEST_P(SharedItemsContract, WhatGoesForTheBoundIsAChange) {
  FreshBegin();
  std::vector<storage::CommitRecord> records = {Object("old", ScopeType::kFleet, 1'000)};
  for (std::size_t i = 1; i < storage::kObjectsPerRobotMax; ++i) {
    records.push_back(Object(std::to_string(i), ScopeType::kRobot));
  }
  Commit(std::move(records));
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("old")));
  EXPECT_THAT(Commit({At(2'000, Object("new"))}), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(Changed(), UnorderedElementsAre(ObjectKey("old"), ObjectKey("new")));
  EXPECT_THAT(Commit({At(2'000, Object("one more"))}), ElementsAre(OutcomeKind::kRefused));
  EXPECT_THAT(Changed(), IsEmpty());
}

TEST_P(SharedItemsContract, RobotsOfAllFleetsAreThereWithTheirFleets) {
  FreshBegin();
  const storage::RobotRef other = Robot("d", "f2");
  OpenAlso({other});
  Commit({Object("same"), Of(other, Object("same"))});
  EXPECT_THAT(Changed(), UnorderedElementsAre(ObjectKey("same"), ObjectKey("same", "d")));
  const std::vector<SharedItem> items = AllItems();
  ASSERT_THAT(items, SizeIs(2));
  EXPECT_EQ(items[0].robot().fleet, "f1");
  EXPECT_EQ(items[1].robot().fleet, "f2");
}

TEST_P(SharedItemsContract, ARobotThatMovesToAnotherFleetTakesItsItemsWithIt) {
  FreshBegin();
  Commit(
      {Shape("s"), Object("o"), Shape("own", ScopeType::kRobot), Of(Robot("b"), Object("stays"))});
  EXPECT_THAT(Changed(), SizeIs(3));
  OpenAlso({Robot("a", "f2")});
  EXPECT_THAT(Changed(), UnorderedElementsAre(ShapeKey("s"), ObjectKey("o")));
  for (const SharedItem& item : AllItems()) {
    EXPECT_EQ(item.robot().fleet, item.robot().ruri == robot_->ruri ? "f2" : "f1");
  }
  OpenAlso({Robot("a", "f2")});
  EXPECT_THAT(Changed(), IsEmpty()) << "it is there already";
}

TEST_P(SharedItemsContract, PagesHaveEachItemOnceInTheOrderOfKeys) {
  FreshBegin();
  std::vector<storage::CommitRecord> records;
  for (std::size_t i = 0; i < storage::kSharedPageMax; ++i) {
    records.push_back(Object(std::to_string(i)));
    records.push_back(Object("r" + std::to_string(i), ScopeType::kRobot));
  }
  Commit(std::move(records));
  EXPECT_THAT(Present(), SizeIs(storage::kSharedPageMax));
  const int most = pages_;
  EXPECT_LE(most, 2);
  Commit({Shape("\xC3\xA9"), Shape("Z"), Of(Robot("b"), Shape("!")), Of(Robot("b"), Object("x"))});
  pages_ = 0;
  const std::vector<ItemKey> keys = Present();
  EXPECT_GE(pages_, 2);
  EXPECT_THAT(keys, SizeIs(storage::kSharedPageMax + 4));
  EXPECT_TRUE(std::ranges::is_sorted(keys));
  EXPECT_EQ(std::ranges::adjacent_find(keys), keys.end());
  EXPECT_EQ(keys[0], ShapeKey("Z"));
  EXPECT_EQ(keys[1], ShapeKey("\xC3\xA9"));
  EXPECT_EQ(keys[2], ShapeKey("!", "b"));
  EXPECT_EQ(keys.back(), ObjectKey("x", "b"));
}

TEST_P(SharedItemsContract, APageEndsOnceItsTextsAreLarge) {
  FreshBegin();
  model::ReportedShape shape = test::SampleShape();
  model::Positions positions(schema::kShapePositionsMax, {8.123456789012345, 47.12345678901234});
  shape.data = model::LineString{std::move(positions)};
  const std::size_t item_bytes = json::GeometryText(shape.data).size();
  const std::size_t fit = storage::kPageBytesMax / item_bytes;
  std::vector<storage::CommitRecord> records;
  for (std::size_t i = 0; i < fit + 10; ++i) {
    shape.identity.id = std::to_string(i);
    records.push_back(Good(++numbers_, model::ShapeOp{shape}));
  }
  Commit(std::move(records));
  const storage::SharedPage page = ValueOf(Items().Page(std::nullopt));
  EXPECT_TRUE(page.more);
  EXPECT_LE(page.items.size(), fit + 1) << "the one with which they pass the bound is the last";
  EXPECT_GE(page.items.size(), fit);
  EXPECT_THAT(Present(), SizeIs(fit + 10));
}

TEST_P(SharedItemsContract, ChangesBetweenPositionsAndItemsAreNotLost) {
  Fresh();
  Commit({Object("before"), Object("gone")});
  Begin();
  Commit({NoObject("gone"), Object("new")});
  EXPECT_THAT(Present(), ElementsAre(ObjectKey("before"), ObjectKey("new")));
  EXPECT_THAT(Changed(), UnorderedElementsAre(ObjectKey("gone"), ObjectKey("new")));
  EXPECT_THAT(Changed(), IsEmpty());
}

TEST_P(SharedItemsContract, ABatchThatIsSentAgainChangesNothing) {
  FreshBegin();
  storage::Batch batch;
  batch.records = {Object("o"), Shape("s")};
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Changed(), SizeIs(2));
  EXPECT_THAT(Commit(batch), SizeIs(2));
  EXPECT_THAT(Changed(), IsEmpty());
}

TEST_P(SharedItemsContract, ATransactionThatFailsLeavesNoHole) {
  FreshBegin();
  storage::Batch batch;
  batch.records = {Object("o")};
  for (int i = 0; i < 2; ++i) {
    store_->FailNextWrite(kProcess);
    EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
    EXPECT_THAT(Changed(), IsEmpty());
    Commit(batch);
    EXPECT_THAT(Changed(), ElementsAre(ObjectKey("o"))) << "not taken for one that went";
    batch.records = {Object("o")};
  }
}

TEST_P(SharedItemsContract, WhatIsNamedOftenIsNamedOnceInTheOrderOfFirstChanges) {
  FreshBegin();
  Commit({Object("b")});
  Commit({Object("a")});
  Commit({Object("b"), Object("b")});
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("b"), ObjectKey("a")));
}

TEST_P(SharedItemsContract, EveryProcessSeesWhatAnotherChanged) {
  FreshBegin();
  Open(Request(), kOther);
  Commit({Object("o")}, kOther);
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("o")));
  store_->Reopen();
  Open(Request(), kProcess);
  Commit({Object("p")});
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("p"))) << "by new connections of all";
}

TEST_P(SharedItemsContract, AnAnswerHasSoManyChanges) {
  FreshBegin();
  std::vector<storage::CommitRecord> records;
  for (std::size_t i = 0; i < storage::kChangesReadMax; ++i) {
    records.push_back(Object(std::to_string(i)));
  }
  records.pop_back();
  Commit(std::move(records));
  EXPECT_THAT(Changed(), SizeIs(storage::kChangesReadMax - 1)) << "the answer is not full";
  store_->AddChanges(storage::kChangesReadMax + 1);
  SharedChanges changes = ValueOf(Items().ChangesSince(positions_));
  EXPECT_TRUE(changes.more);
  EXPECT_THAT(changes.keys, ElementsAre(ObjectKey("i", "x")));
  positions_ = changes.positions;
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("i", "x"))) << "the last one";
  EXPECT_THAT(Changed(), IsEmpty());
}

TEST_P(SharedItemsContract, SoManyChangesAreKeptAndWhoIsFurtherBehindIsTold) {
  FakeTrust trust;
  FreshBegin({.clock = &trust});
  trust.Set(false);  // they do not go by the time
  storage::Store& store = store_->Process(kProcess);
  store_->AddChanges(storage::kChangesKept);
  ASSERT_EQ(store.Sweep(Time())->items, 0U);
  const ChangePositions begun = positions_;
  EXPECT_GT(SkipChanges(), static_cast<int>(storage::kChangesKept / storage::kChangesReadMax));
  EXPECT_THAT(Changed(), IsEmpty());
  const ChangePositions current = std::exchange(positions_, begun);
  store_->AddChanges(1);
  EXPECT_FALSE(IsTrimmed());
  const auto swept = ValueOf(store.Sweep(Time()));
  EXPECT_EQ(swept.items, 0U);
  EXPECT_EQ(swept.changes, 1U);
  EXPECT_TRUE(IsTrimmed());
  const SharedChanges trimmed = ValueOf(Items().ChangesSince(begun));
  EXPECT_THAT(trimmed.keys, IsEmpty());
  EXPECT_FALSE(trimmed.more);
  positions_ = current;
  EXPECT_THAT(Changed(), ElementsAre(ObjectKey("i", "x"))) << "who has read so far misses nothing";
}

TEST_P(SharedItemsContract, AnOlderCopyOfTheStoreIsFoundOut) {
  FreshBegin();
  Commit({Object("o")});
  EXPECT_THAT(Changed(), SizeIs(1));
  EXPECT_FALSE(IsTrimmed());
  ASSERT_THAT(positions_.writers, SizeIs(1));
  ++positions_.writers.begin()->second.number;
  EXPECT_TRUE(IsTrimmed()) << "a change was read that is not there";
}

INSTANTIATE_TEST_SUITE_P(Stores, SharedItemsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
