#include <cstdint>
#include <vector>

#include <gmock/gmock.h>

#include "tests/contract/topic_contract.h"

/// What is remembered of messages that a broker may deliver again.
namespace uplink::testing {
namespace {

using storage::Delivery;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RedeliveryContract : public TopicContract {
 protected:
  RedeliveryContract() {
    Open();
    hold_ = Hold(Take(Wants()));
  }
  static Delivery Of(std::uint64_t number, std::uint16_t packet_id, std::uint8_t content) {
    return {number, packet_id, storage::DeliveryDigest{content, 0xFF, 0, '\''}};
  }
  static Delivery Ended(std::uint64_t number, std::uint16_t packet_id) {
    return {number, packet_id, std::nullopt};
  }
  storage::Batch With(std::vector<storage::CommitRecord> records,
                      std::vector<Delivery> deliveries) const {
    storage::Batch batch;
    batch.records = std::move(records);
    batch.deliveries = {{hold_, std::move(deliveries)}};
    return batch;
  }

  storage::TopicHoldRef hold_;
};

TEST_P(RedeliveryContract, IsKeptWithTheRowsOfItsMessage) {
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_EQ(Memory().last_number, 0U);
  Commit(With({Under(hold_, Good(1)), Under(hold_, Bad(2))}, {Of(1, 7, 1), Of(2, 65'535, 2)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 65'535, 2)));
  EXPECT_EQ(Memory().last_number, 2U);
  EXPECT_THAT(Memory("other").known, IsEmpty());
  store_->Reopen();
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 65'535, 2)));
}

TEST_P(RedeliveryContract, IsKeptWithoutRecordsToo) {
  Commit(With({}, {Of(1, 7, 1)}));
  EXPECT_THAT(Memory().known, SizeIs(1));
}

TEST_P(RedeliveryContract, NothingOfItIsKeptWithoutTheRows) {
  store_->FailNextWrite(kProcess);
  const storage::Batch batch = With({Under(hold_, Good(1))}, {Of(1, 7, 1)});
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_THAT(Messages(), IsEmpty());

  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
  EXPECT_THAT(Messages(), SizeIs(1));
  for (const storage::Outcome& outcome : Commit(batch)) {
    EXPECT_EQ(outcome.kind, OutcomeKind::kDuplicate);
  }
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1))) << "the same again changes nothing";
}

TEST_P(RedeliveryContract, IsKeptBesideARecordThatTheDatabaseRefuses) {
  store_->RefuseFault("poison");
  Commit(With({Under(hold_, Good(1, Fault("poison"))), Under(hold_, Good(2))},
              {Of(1, 7, 1), Of(2, 8, 2)}));
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 8, 2)));
}

TEST_P(RedeliveryContract, TheLatestOfAPacketIdCounts) {
  Commit(With({}, {Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(With({}, {Of(3, 7, 3)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2), Of(3, 7, 3)));
  // Writers commit in any order.
  Commit(With({}, {Of(5, 9, 5)}));
  Commit(With({}, {Of(4, 9, 4)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2), Of(3, 7, 3), Of(5, 9, 5)));
  EXPECT_EQ(Memory().last_number, 5U);
}

TEST_P(RedeliveryContract, EndsWhereThePacketIdWasUsedAnew) {
  Commit(With({}, {Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(With({}, {Ended(3, 7)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2)));
  EXPECT_EQ(Memory().last_number, 3U);
}

TEST_P(RedeliveryContract, EndsWithTheBrokersSession) {
  Commit(With({}, {Of(1, 7, 1), Of(2, 8, 2)}));
  storage::Batch batch = With({}, {Of(4, 7, 4)});
  batch.deliveries[0].forget_below = 4;
  Commit(batch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(4, 7, 4)));
  // One of the session before that waited until now.
  Commit(With({}, {Of(3, 9, 3)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(4, 7, 4)));
  store_->Reopen();
  EXPECT_THAT(Memory().known, ElementsAre(Of(4, 7, 4)));
}

TEST_P(RedeliveryContract, NumbersGoOnAfterASessionThatLeftNothing) {
  Commit(With({}, {Of(1, 7, 1), Of(2, 8, 2)}));
  storage::Batch batch = With({}, {});
  batch.deliveries[0].forget_below = 3;
  Commit(batch);
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_EQ(Memory().last_number, 2U);
}

TEST_P(RedeliveryContract, TheLastOnesAreKeptAndNoMore) {
  constexpr std::uint32_t kKept = 5;
  for (std::uint64_t number = 1; number <= 12; ++number) {
    storage::Batch batch = With(
        {}, {Of(number, static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(number))});
    batch.deliveries[0].kept_max = kKept;
    Commit(batch);
    EXPECT_THAT(Memory().known, SizeIs(std::min<std::uint64_t>(number, kKept)));
  }
  EXPECT_EQ(Memory().known.front().number, 8U);
  EXPECT_EQ(Memory().known.back().number, 12U);
  // Fewer are to be kept from the next start on.
  storage::TakeRequest fewer = Wants();
  fewer.deliveries_max = 2;
  Take(fewer);
  EXPECT_THAT(Memory().known, SizeIs(2));
  EXPECT_EQ(Memory().last_number, 12U);
}

TEST_P(RedeliveryContract, AWholeBatchOfThemIsBoundedToo) {
  std::vector<Delivery> deliveries;
  for (std::uint16_t i = 1; i <= 3'000; ++i) deliveries.push_back(Of(i, i, 1));
  storage::Batch batch = With({}, std::move(deliveries));
  batch.deliveries[0].kept_max = 1'024;
  Commit(batch);
  const storage::DeliveryMemory memory = Memory();
  ASSERT_THAT(memory.known, SizeIs(1'024));
  EXPECT_EQ(memory.known.front().number, 1'977U);
}

TEST_P(RedeliveryContract, GoesOnWithWhoeverTakesTheLease) {
  Commit(With({Under(hold_, Good(1))}, {Of(1, 7, 1)}));
  const storage::TopicHoldRef stale = hold_;
  hold_ = Hold(Take(After(kProcess, Wants()), kOther));
  EXPECT_THAT(Memory("uplinkd", kOther).known, ElementsAre(Of(1, 7, 1)));
  Commit(With({}, {Of(2, 8, 2)}), kOther);
  // Who was killed, or was only slow, adds nothing and ends nothing.
  storage::Batch late;
  late.records = {Under(stale, Good(2))};
  late.deliveries = {{stale, {Of(3, 9, 3)}, 3}};
  for (const storage::Outcome& outcome : Commit(late)) {
    EXPECT_EQ(outcome.kind, OutcomeKind::kFenced);
  }
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 8, 2)));
  EXPECT_THAT(Messages(), SizeIs(1));
}

TEST_P(RedeliveryContract, OfTwoClientIdsIsKeptApart) {
  const storage::TopicHoldRef other = Hold(Take(Wants({"b"}, "other")), "other");
  storage::Batch batch;
  batch.deliveries = {{hold_, {Of(1, 7, 1)}}, {other, {Of(1, 7, 2), Of(2, 8, 2)}, 0, 1}};
  Commit(batch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
  EXPECT_THAT(Memory("other").known, ElementsAre(Of(2, 8, 2)));
}

INSTANTIATE_TEST_SUITE_P(Stores, RedeliveryContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
