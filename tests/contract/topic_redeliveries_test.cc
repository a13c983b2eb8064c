#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
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
  using TopicContract::Of;
  static Delivery Of(std::uint64_t number, std::uint16_t packet_id, std::uint8_t content) {
    return {number, packet_id, storage::DeliveryDigest{content, 0xFF, 0, '\''}};
  }
  static Delivery Ended(std::uint64_t number, std::uint16_t packet_id) {
    return {number, packet_id, std::nullopt};
  }
  /// With packet id 0: the broker lost the session.
  static Delivery Lost(std::uint64_t number) { return Ended(number, 0); }

  /// The last of so many records of a message that came under the lease.
  storage::CommitRecord Ends(const Delivery& delivery, storage::CommitRecord record,
                             std::uint32_t records = 1) const {
    record = Under(hold_, std::move(record));
    record.message_end = {{delivery}, records};
    return record;
  }
  static storage::Batch BatchOf(std::vector<storage::CommitRecord> records) {
    storage::Batch batch;
    batch.records = std::move(records);
    return batch;
  }
  /// Of messages without records.
  storage::Batch Rows(std::vector<Delivery> rows) const {
    storage::Batch batch;
    batch.deliveries = {{hold_, std::move(rows)}};
    return batch;
  }
  /// The same lease, under a smaller window.
  void Narrow(std::uint32_t unacked_max) {
    storage::TopicHold hold = *hold_;
    hold.unacked_max = unacked_max;
    hold_ = std::make_shared<const storage::TopicHold>(std::move(hold));
  }
  /// Another process is the holder of the fixture's robot now.
  void LoseRobot() { Open(Request(), kOther); }

  storage::TopicHoldRef hold_;
};

TEST_P(RedeliveryContract, IsKeptWithTheRowsOfItsMessage) {
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_EQ(Memory().last_number, 0U);
  Commit({Ends(Of(1, 7, 1), Good(1)), Ends(Of(2, 65'535, 2), Bad(2))});
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 65'535, 2)));
  EXPECT_EQ(Memory().last_number, 2U);
  EXPECT_THAT(Memory("other").known, IsEmpty());
  store_->Reopen();
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 65'535, 2)));
}

TEST_P(RedeliveryContract, IsKeptOfWhatCameBeforeItToo) {
  const auto batch = [this] {
    storage::CommitRecord record = Ends(Of(3, 9, 3), Good(1));
    record.message_end->deliveries = {Of(1, 7, 1), Of(2, 8, 2), Of(3, 9, 3)};
    return BatchOf({std::move(record)});
  };
  store_->FailNextWrite(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch()).ok());
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_THAT(Commit(batch()),
              Each(::testing::Field(&storage::Outcome::kind, OutcomeKind::kStored)));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 8, 2), Of(3, 9, 3)));
  EXPECT_EQ(Memory().last_number, 3U);
}

TEST_P(RedeliveryContract, IsKeptWithoutRecordsToo) {
  Commit(Rows({Of(1, 7, 1)}));
  EXPECT_THAT(Memory().known, SizeIs(1));
}

TEST_P(RedeliveryContract, IsKeptOfAMessageThatIsButARowOfQuarantine) {
  const auto nobody =
      std::make_shared<const model::RobotId>(model::RobotId{storage::NoRobotOf("local"), "f1"});
  OpenAlso({nobody});
  const auto message = [&] { return Ends(Of(1, 7, 1), Of(nobody, Bad(1))); };
  EXPECT_THAT(Commit({message()}), Each(OutcomeKind::kStored));
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
  EXPECT_THAT(Commit({message()}), Each(OutcomeKind::kRefused)) << "the same again";
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
}

TEST_P(RedeliveryContract, NothingOfItIsKeptWithoutTheRows) {
  store_->FailNextWrite(kProcess);
  const storage::Batch batch = BatchOf({Ends(Of(1, 7, 1), Good(1))});
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_THAT(Messages(), IsEmpty());

  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
  EXPECT_THAT(Messages(), SizeIs(1));
  EXPECT_THAT(KindsOf(Commit(batch)), Each(OutcomeKind::kDuplicate));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1))) << "the same again changes nothing";
}

TEST_P(RedeliveryContract, IsNotKeptOfAMessageThatWasFenced) {
  OpenAlso({Robot("b")});
  const auto batch = [this] {
    return BatchOf({Ends(Of(1, 7, 1), Of(Robot("b"), Good(1))), Under(hold_, Good(1)),
                    Ends(Of(2, 8, 2), Good(2), 2), Ends(Of(3, 9, 3), Of(Robot("b"), Good(2)))});
  };
  const storage::Batch before = batch();
  LoseRobot();
  std::vector<OutcomeKind> kinds;
  for (const storage::Outcome& outcome : Commit(before)) kinds.push_back(outcome.kind);
  EXPECT_THAT(kinds, ElementsAre(OutcomeKind::kStored, OutcomeKind::kFenced, OutcomeKind::kFenced,
                                 OutcomeKind::kStored));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(3, 9, 3)));
  // The broker delivers it again, and the robot is held anew.
  Open();
  EXPECT_THAT(Commit({Under(hold_, Good(1)), Ends(Of(2, 8, 2), Good(2), 2)}),
              Each(OutcomeKind::kStored));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(2, 8, 2), Of(3, 9, 3)));
  EXPECT_THAT(Messages(), SizeIs(4));
}

TEST_P(RedeliveryContract, OneFencedRecordOfItsMessageIsEnough) {
  OpenAlso({Robot("b")});
  const storage::Batch batch = BatchOf(
      {Under(hold_, Good(1)), Under(hold_, Of(Robot("b"), Good(1))),
       Ends(Of(1, 7, 1), Of(Robot("b"), Good(2)), 3), Ends(Of(2, 8, 2), Of(Robot("b"), Good(3)))});
  LoseRobot();
  Commit(batch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2)));
}

TEST_P(RedeliveryContract, IsKeptBesideARecordThatTheDatabaseRefuses) {
  store_->RefuseFault("poison");
  OpenAlso({Robot("b")});
  // One message over both halves of the batch, and one that is fenced.
  const storage::Batch batch = BatchOf(
      {Under(hold_, Of(Robot("b"), Good(1))),
       Ends(Of(1, 7, 1), Of(Robot("b"), Good(2, Fault("poison"))), 2), Ends(Of(2, 8, 2), Good(1)),
       Under(hold_, Of(Robot("b"), Good(3))), Under(hold_, Of(Robot("b"), Good(4))),
       Ends(Of(3, 9, 3), Of(Robot("b"), Good(5)), 3)});
  LoseRobot();
  Commit(batch);
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1), Of(3, 9, 3)));
}

TEST_P(RedeliveryContract, TheLatestOfAPacketIdCounts) {
  Commit(Rows({Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(Rows({Of(3, 7, 3)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2), Of(3, 7, 3)));
  // Writers commit in any order.
  Commit(Rows({Of(5, 9, 5)}));
  Commit(Rows({Of(4, 9, 4)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2), Of(3, 7, 3), Of(5, 9, 5)));
  EXPECT_EQ(Memory().last_number, 5U);
}

TEST_P(RedeliveryContract, EndsWhereThePacketIdWasUsedAnew) {
  Commit(Rows({Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(Rows({Ended(3, 7)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2)));
  EXPECT_EQ(Memory().last_number, 3U);
}

TEST_P(RedeliveryContract, EndsWithTheBrokersSession) {
  Commit(Rows({Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(Rows({Lost(4), Of(5, 7, 4)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(5, 7, 4)));
  // One of the session before that waited until now.
  Commit(Rows({Of(3, 9, 3)}));
  EXPECT_THAT(Memory().known, ElementsAre(Of(5, 7, 4)));
  store_->Reopen();
  EXPECT_THAT(Memory().known, ElementsAre(Of(5, 7, 4)));
  Take(After(kProcess, Wants()), kOther);
  EXPECT_THAT(Memory().known, ElementsAre(Of(6, 7, 4)));
}

TEST_P(RedeliveryContract, NumbersGoOnAfterASessionThatLeftNothing) {
  Commit(Rows({Of(1, 7, 1), Of(2, 8, 2)}));
  Commit(Rows({Lost(3)}));
  EXPECT_THAT(Memory().known, IsEmpty());
  EXPECT_EQ(Memory().last_number, 3U);
  Take(After(kProcess, Wants()), kOther);
  EXPECT_THAT(Memory().known, IsEmpty());
}

TEST_P(RedeliveryContract, TwiceTheWindowIsKeptAndNoMore) {
  Narrow(3);
  for (std::uint64_t number = 1; number <= 12; ++number) {
    const Delivery delivery = Of(number, static_cast<std::uint16_t>(number), 1);
    if (number % 2 == 0) {
      Commit(Rows({delivery}));
    } else {
      Commit({Ends(delivery, Good(number))});
    }
    EXPECT_THAT(Memory().known, SizeIs(std::min<std::uint64_t>(number, 6)));
  }
  EXPECT_EQ(Memory().known.front(), Of(7, 7, 1));
  EXPECT_EQ(Memory().known.back(), Of(12, 12, 1));
  // The next lease keeps fewer.
  storage::TakeRequest fewer = After(kProcess, Wants());
  fewer.unacked_max = 1;
  Take(fewer, kOther);
  EXPECT_THAT(Memory().known, ElementsAre(Of(13, 11, 1), Of(14, 12, 1)));
  EXPECT_EQ(Memory().last_number, 14U);
}

TEST_P(RedeliveryContract, OneThatWasFencedMakesRoomAllTheSame) {
  OpenAlso({Robot("b")});
  Narrow(1);
  const storage::Batch batch =
      BatchOf({Ends(Of(1, 7, 1), Of(Robot("b"), Good(1))),
               Ends(Of(2, 8, 2), Of(Robot("b"), Good(2))), Ends(Of(3, 9, 3), Good(1))});
  LoseRobot();
  Commit(batch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 8, 2)));
}

TEST_P(RedeliveryContract, AWholeBatchOfThemIsBoundedToo) {
  std::vector<Delivery> deliveries;
  for (std::uint16_t i = 1; i <= 3'000; ++i) deliveries.push_back(Of(i, i, 1));
  Narrow(512);
  Commit(Rows(std::move(deliveries)));
  const storage::DeliveryMemory memory = Memory();
  ASSERT_THAT(memory.known, SizeIs(1'024));
  EXPECT_EQ(memory.known.front().number, 1'977U);
}

TEST_P(RedeliveryContract, GoesOnWithWhoeverTakesTheLease) {
  Commit({Ends(Of(1, 7, 1), Good(1))});
  const storage::TopicHoldRef stale = hold_;
  hold_ = Hold(Take(After(kProcess, Wants()), kOther));
  EXPECT_THAT(Memory("uplinkd", kOther).known, ElementsAre(Of(2, 7, 1)));
  EXPECT_EQ(Memory("uplinkd", kOther).last_number, 2U);
  Commit(Rows({Of(3, 8, 2)}), kOther);
  // Who was killed, or was only slow, adds nothing and ends nothing.
  hold_ = stale;
  Narrow(1);
  storage::Batch late = BatchOf({Ends(Of(4, 9, 3), Good(2))});
  late.deliveries = {{hold_, {Lost(5), Ended(6, 7)}}};
  EXPECT_THAT(KindsOf(Commit(late)), Each(OutcomeKind::kFenced));
  EXPECT_THAT(Memory().known, ElementsAre(Of(2, 7, 1), Of(3, 8, 2)));
  EXPECT_THAT(Messages(), SizeIs(1));
}

TEST_P(RedeliveryContract, IsNumberedAnewWithTheLeaseAndWithoutAHole) {
  Commit(Rows({Of(1, 7, 1), Of(3, 8, 2), Of(4, 9, 3), Ended(5, 9), Of(9, 7, 4)}));
  EXPECT_EQ(Take(Wants()), hold_->epoch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(3, 8, 2), Of(9, 7, 4))) << "the same lease";
  Take(After(kProcess, Wants()), kOther);
  EXPECT_THAT(Memory().known, ElementsAre(Of(10, 8, 2), Of(11, 7, 4)));
  EXPECT_EQ(Memory().last_number, 11U);
}

TEST_P(RedeliveryContract, OfTwoClientIdsIsKeptApart) {
  const storage::TopicHoldRef other = std::make_shared<const storage::TopicHold>(
      storage::TopicHold{"other", *Take(Wants({"b"}, "other")), 1});
  storage::Batch batch;
  batch.deliveries = {{hold_, {Of(1, 7, 1)}}, {other, {Of(1, 7, 2), Of(2, 8, 2), Of(3, 9, 3)}}};
  Commit(batch);
  EXPECT_THAT(Memory().known, ElementsAre(Of(1, 7, 1)));
  EXPECT_THAT(Memory("other").known, ElementsAre(Of(2, 8, 2), Of(3, 9, 3)));
}

INSTANTIATE_TEST_SUITE_P(Stores, RedeliveryContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
