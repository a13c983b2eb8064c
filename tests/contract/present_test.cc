#include <chrono>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/present_contract.h"
#include "tests/unit/schema/samples.h"

/// Shapes and objects: which are there, in which place, for how long.
namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kKeptMs = milliseconds(storage::kExpiredKept).count();

TEST_P(PresentContract, KeepsItsPlaceWhileItChanges) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "first", 0), Upsert(kind, "second", 10)});
    Commit({Upsert(kind, "first", 20)});
    EXPECT_THAT(Ids(kind, 20), ElementsAre("second", "first"));
    EXPECT_EQ(Seen(kind, 20).at(1).received_at, Time(20));
    storage::PresentQuery query;
    query.rows.to = Time(0);
    EXPECT_THAT(RowsOf(kind.read(store_->reader(), query)), SizeIs(1))
        << "from and to are of the place";
    query.rows.to = {};
    query.rows.from = Time(11);
    EXPECT_THAT(RowsOf(kind.read(store_->reader(), query)), IsEmpty());
  });
}

TEST_P(PresentContract, DeletesAndBeginsAnew) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0), Upsert(kind, "b", 1)});
    EXPECT_THAT(Commit({Delete(kind, "a")}), ElementsAre(OutcomeKind::kStored));
    EXPECT_THAT(Ids(kind, 1, true), ElementsAre("b"));
    EXPECT_THAT(Commit({Upsert(kind, "a", 2), Delete(kind, "b"), Upsert(kind, "b", 1)}),
                Each(OutcomeKind::kStored));
    EXPECT_THAT(Ids(kind, 2), ElementsAre("a", "b"));
  });
}

TEST_P(PresentContract, StoresTheDeleteOfAnUnknownId) {
  ForEachKind([this](const PresentKind& kind) {
    EXPECT_THAT(Commit({Delete(kind, "none")}), ElementsAre(OutcomeKind::kStored));
    EXPECT_EQ(CursorNow(), 1);
    EXPECT_EQ(Count(kind), 0U);
    EXPECT_THAT(Quarantine(), IsEmpty());
  });
}

TEST_P(PresentContract, TellsIdsApartByRobotAndKind) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0), Of(Robot("b"), Upsert(kind, "a", 1))});
    for (const PresentKind& other : PresentKinds()) {
      if (other.name != std::string(kind.name)) Commit({Delete(other, "a")});
    }
    EXPECT_THAT(Ids(kind, 1), ElementsAre("a", "a"));
    Commit({Delete(kind, "a")});
    const auto left = Seen(kind, 1);
    ASSERT_THAT(left, SizeIs(1));
    EXPECT_EQ(left[0].robot, *Robot("b"));
  });
}

TEST_P(PresentContract, MovesToTheFleetOfItsLastUpsert) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0)});
    Commit({Of(Robot("a", "f2"), Upsert(kind, "a", 1))});
    storage::PresentQuery query;
    query.rows.fleets = {"f1"};
    EXPECT_THAT(RowsOf(kind.read(store_->reader(), query)), IsEmpty());
    query.rows.fleets = {"f2"};
    EXPECT_THAT(RowsOf(kind.read(store_->reader(), query)), SizeIs(1));
  });
}

TEST_P(PresentContract, IsThereUntilItExpires) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "short", 0, 1'000), Upsert(kind, "long", 1, 2'000)});
    EXPECT_THAT(Ids(kind, 999), ElementsAre("long", "short"));
    EXPECT_THAT(Ids(kind, 1'000), ElementsAre("long"));
    EXPECT_THAT(Ids(kind, 1'999), ElementsAre("long"));
    EXPECT_THAT(Ids(kind, 2'000), IsEmpty());
    EXPECT_THAT(Ids(kind, 1'000'000, true), ElementsAre("long", "short"));
  });
}

TEST_P(PresentContract, PagesWhatHasNotExpired) {
  ForEachKind([this](const PresentKind& kind) {
    for (int i = 0; i < 10; ++i) {
      Commit({Upsert(kind, std::to_string(i), i, i % 2 == 0 ? 1'000 : 2'000)});
    }
    storage::PresentQuery query;
    query.now = Time(1'000);
    query.rows.page_size = 3;
    const auto page = kind.read(store_->reader(), query);
    ASSERT_TRUE(page.ok()) << page.status();
    ASSERT_THAT(page->rows, SizeIs(3));
    EXPECT_EQ(page->rows[2].id, "5");
    query.rows.page_token = page->next_token;
    const auto rest = kind.read(store_->reader(), query);
    ASSERT_TRUE(rest.ok()) << rest.status();
    ASSERT_THAT(rest->rows, SizeIs(2));
    EXPECT_EQ(rest->rows[1].id, "1");
    EXPECT_EQ(rest->next_token, "");
  });
}

TEST_P(PresentContract, BeginsAnewWithAnIdThatHasExpired) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "just alive", 0, 1'000), Upsert(kind, "expired", 0, 1'000),
            Upsert(kind, "other", 500)});
    Commit({Upsert(kind, "just alive", 999), Upsert(kind, "expired", 1'000)});
    EXPECT_THAT(Ids(kind, 1'000), ElementsAre("expired", "other", "just alive"));
    EXPECT_EQ(Count(kind), 3U);
  });
}

TEST_P(PresentContract, ShapesWithoutExpiryAreThereForEver) {
  for (const milliseconds ttl : {milliseconds(0), milliseconds(1'000)}) {
    Fresh({.object_ttl = ttl});
    model::ReportedShape shape = test::SampleShape();
    shape.expire_time_ms = 0;
    Commit({Good(1, model::ShapeOp{shape})});
    EXPECT_THAT(Shapes(1'000'000'000'000), SizeIs(1));
    EXPECT_EQ(Shapes().at(0).expires_at_ms, 0);
  }
}

TEST_P(PresentContract, ObjectsWithoutExpiryLiveAsLongAsConfigured) {
  model::Object object = test::SampleObject();
  object.expires_unix_time_ms = 0;
  Fresh({.object_ttl = milliseconds(1'000)});
  Commit({At(10, Good(1, model::ObjectOp{object}))});
  EXPECT_EQ(Objects().at(0).expires_at_ms, kNowMs + 1'010);
  EXPECT_THAT(Objects(1'009), SizeIs(1));
  EXPECT_THAT(Objects(1'010), IsEmpty());
  Commit({At(500, Good(2, model::ObjectOp{object}))});
  EXPECT_THAT(Objects(1'499), SizeIs(1)) << "its life begins with the last upsert";

  Fresh();
  Commit({Good(1, model::ObjectOp{object})});
  EXPECT_EQ(Objects().at(0).expires_at_ms, kNowMs + 86'400'000);

  Fresh({.object_ttl = milliseconds(0)});
  Commit({Good(1, model::ObjectOp{object})});
  EXPECT_EQ(Objects().at(0).expires_at_ms, 0);
  EXPECT_THAT(Objects(1'000'000'000'000), SizeIs(1));
}

TEST_P(PresentContract, SweepsWhatExpiredLongEnoughAgo) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0, 1'000), Upsert(kind, "b", 1, 1'001)});
    storage::Store& store = store_->Process(kProcess);
    EXPECT_EQ(store.Sweep(Time(1'000 + kKeptMs - 1))->items, 0U);
    EXPECT_EQ(Count(kind), 2U);
    EXPECT_EQ(store.Sweep(Time(1'000 + kKeptMs))->items, 1U);
    EXPECT_THAT(Ids(kind, 1'001, true), ElementsAre("b"));
    EXPECT_EQ(store.Sweep(Time(1'000 + kKeptMs))->items, 0U) << "it went";
  });
}

TEST_P(PresentContract, SweepsNothingByAClockThatNobodyVouchesFor) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0, 1'000)});
    storage::Store& store = store_->Process(kProcess);
    trust_.Set(false);
    EXPECT_EQ(store.Sweep(Time(100 * kKeptMs))->items, 0U);
    EXPECT_EQ(Count(kind), 1U);
    trust_.Set(true);
    EXPECT_EQ(store.Sweep(Time(100 * kKeptMs))->items, 1U);
  });
}

TEST_P(PresentContract, NothingHasExpiredWhereNobodyVouchesForTheClock) {
  ForEachKind([this](const PresentKind& kind) {
    Commit({Upsert(kind, "a", 0, 1'000), Upsert(kind, "b", 1)});
    trust_.Set(false);
    // Without a word on the clock, `a` would be a new entry, before `b`.
    Commit({Upsert(kind, "a", 2'000)});
    EXPECT_THAT(Ids(kind, 2'000), ElementsAre("b", "a")) << "in a batch of its own";
    Commit({Upsert(kind, "c", 3'000, 4'000), Upsert(kind, "d", 3'001), Upsert(kind, "c", 5'000)});
    EXPECT_THAT(Ids(kind, 5'000), ElementsAre("d", "c", "b", "a")) << "within one batch";
  });
}

TEST_P(PresentContract, SweepsBothKindsInOneCall) {
  Open();
  std::vector<storage::CommitRecord> records;
  for (const PresentKind& kind : PresentKinds()) records.push_back(Upsert(kind, "a", 0, 1'000));
  Commit(std::move(records));
  EXPECT_EQ(store_->Process(kProcess).Sweep(Time(1'000 + kKeptMs))->items, 2U);
  for (const PresentKind& kind : PresentKinds()) EXPECT_EQ(Count(kind), 0U);
}

TEST_P(PresentContract, SweepLeavesWhatLivesForEver) {
  Fresh({.object_ttl = milliseconds(0)});
  model::ReportedShape shape = test::SampleShape();
  shape.expire_time_ms = 0;
  model::Object object = test::SampleObject();
  object.expires_unix_time_ms = 0;
  Commit({Good(1, model::ShapeOp{shape}), Good(2, model::ObjectOp{object})});
  EXPECT_EQ(store_->Process(kProcess).Sweep(Time(1'000'000'000'000))->items, 0U);
  EXPECT_THAT(Shapes(), SizeIs(1));
  EXPECT_THAT(Objects(), SizeIs(1));
}

TEST_P(PresentContract, SweepsSoManyAtOnce) {
  ForEachKind([this](const PresentKind& kind) {
    std::vector<storage::CommitRecord> records;
    for (std::size_t i = 0; i <= storage::kSweepRowsMax; ++i) {
      records.push_back(Upsert(kind, std::to_string(i), 0, 1'000));
    }
    records[0] = Of(Robot("b"), records[0]);
    Commit(std::move(records));
    storage::Store& store = store_->Process(kProcess);
    const SystemTime then = Time(1'000 + kKeptMs);
    EXPECT_EQ(store.Sweep(then)->items, storage::kSweepRowsMax);
    EXPECT_EQ(Count(kind), 1U);
    EXPECT_EQ(store.Sweep(then)->items, 1U);
    EXPECT_EQ(store.Sweep(then)->items, 0U);
    EXPECT_EQ(Count(kind), 0U);
    // What was swept may come again.
    Commit({Upsert(kind, "1", 2'000)});
    EXPECT_EQ(Count(kind), 1U);
  });
}

}  // namespace
}  // namespace uplink::testing
