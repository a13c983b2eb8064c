#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

/// Rejects that are kept for their robot alone: limited numbers, and what outlives its day of
/// quarantine.
namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;

class KeptRejectsContract : public StoreContract {
 protected:
  storage::OpenResult OpenSettled(model::Seq settled) {
    storage::OpenRequest request = Request();
    request.settled_seq = settled;
    return Open(request);
  }
  static std::vector<model::Seq> NumbersOf(const std::vector<storage::StoredReject>& rejects) {
    std::vector<model::Seq> numbers;
    numbers.reserve(rejects.size());
    for (const storage::StoredReject& reject : rejects) numbers.push_back(reject.seq);
    return numbers;
  }
  std::vector<model::Seq> Told(model::Seq settled = 0) {
    return NumbersOf(OpenSettled(settled).rejects);
  }
  std::vector<model::Seq> Read(model::Seq above, model::Seq through, std::size_t rows_max = 100) {
    const auto page = store_->reader().Rejects({robot_->ruri, session_, above, through, rows_max});
    EXPECT_TRUE(page.ok()) << page.status();
    return NumbersOf(page.value_or(std::vector<storage::StoredReject>()));
  }
  storage::Erased RetainOnce(std::int64_t now_ms) {
    const auto erased = store_->Process(kProcess).Retain(Time(now_ms));
    EXPECT_TRUE(erased.ok()) << erased.status();
    return erased.value_or(storage::Erased());
  }
  std::size_t Retain(std::int64_t now_ms) { return RetainOnce(now_ms).rows; }
  /// Numbers 1 to `through`, all rejected.
  void CommitBad(model::Seq through) {
    std::vector<storage::CommitRecord> records;
    for (model::Seq seq = 1; seq <= through; ++seq) records.push_back(Bad(seq, ""));
    Commit(std::move(records));
  }
};

TEST_P(KeptRejectsContract, EachNumberOfALimitedRangeIsToldWithItsReason) {
  Open();
  EXPECT_THAT(Commit({Good(1), Limited(2, 4), Bad(5), Limited(6, 6)}),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kStored,
                          OutcomeKind::kStored));
  const storage::OpenResult result = Open();
  EXPECT_EQ(result.cursor, 6U);
  EXPECT_EQ(result.rejects_total, 5U);
  EXPECT_THAT(NumbersOf(result.rejects), ElementsAre(2, 3, 4, 5, 6));
  EXPECT_EQ(result.rejects[1].rejection, RateReason());
  EXPECT_EQ(result.rejects[3].rejection, BadReason());
  EXPECT_THAT(Quarantine(), SizeIs(1)) << "that a message was limited is no evidence to keep";
}

TEST_P(KeptRejectsContract, WhatAHelloConfirmsIsGone) {
  Open();
  Commit({Limited(1, 3), Limited(5, 8), Good(9)});
  EXPECT_THAT(Told(2), ElementsAre(3, 5, 6, 7, 8));
  EXPECT_EQ(OpenSettled(2).rejects_total, 5U);
  EXPECT_THAT(Told(3), ElementsAre(5, 6, 7, 8));
  EXPECT_THAT(Told(), ElementsAre(5, 6, 7, 8)) << "1 to 3 were confirmed";
  EXPECT_THAT(Told(100), IsEmpty());
  EXPECT_THAT(Read(0, 100), IsEmpty());
}

TEST_P(KeptRejectsContract, AHelloConfirmsThoseOfItsSessionAlone) {
  Open();
  Commit({Limited(1, 3), Limited(5, 8)});
  session_ = Session(2);
  Open();
  Commit({Limited(1, 3), Limited(5, 8)});
  EXPECT_THAT(Told(100), IsEmpty());
  session_ = Session();
  EXPECT_THAT(Told(3), ElementsAre(5, 6, 7, 8));
  session_ = Session(2);
  EXPECT_THAT(Told(), IsEmpty());
}

TEST_P(KeptRejectsContract, ThePagesHoldThemInOrderUpToTheirBound) {
  Open();
  Commit({Limited(1, 3), Bad(4), Limited(5, 8), Bad(9)});
  EXPECT_THAT(Read(0, 9, 4), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(Read(1, 9, 5), ElementsAre(2, 3, 4, 5, 6));
  EXPECT_THAT(Read(6, 9), ElementsAre(7, 8, 9));
  EXPECT_THAT(Read(2, 6), ElementsAre(3, 4, 5, 6));
  storage::OpenRequest request = Request();
  request.rejects_max = 6;
  const storage::OpenResult result = Open(request);
  EXPECT_THAT(NumbersOf(result.rejects), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(result.rejects_total, 9U);
}

TEST_P(KeptRejectsContract, TheyCountUpToTheBoundOfRejects) {
  Open();
  Commit({Limited(1, storage::kQuarantineRowsPerRobotMax - 1)});
  EXPECT_EQ(Open().rejects_total, storage::kQuarantineRowsPerRobotMax - 1);
  Commit({Bad(storage::kQuarantineRowsPerRobotMax), Bad(storage::kQuarantineRowsPerRobotMax + 1)});
  EXPECT_EQ(Open().rejects_total, storage::kQuarantineRowsPerRobotMax);
  EXPECT_THAT(Open().rejects, SizeIs(storage::kOpenRejectsMax));
}

TEST_P(KeptRejectsContract, ANumberOfARangeIsRefusedWhenItComesAgain) {
  Open();
  storage::Batch batch;
  batch.records = {Limited(2, 4), Good(3), Good(1), Good(5)};
  auto outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(4));
  EXPECT_EQ(outcomes[1].kind, OutcomeKind::kRefused) << "in the same batch";
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kDuplicate);
  batch.records = {Good(2), Good(4), Good(1), Limited(2, 4), Good(5)};
  outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(5));
  for (const std::size_t place : {0U, 1U, 3U}) {
    ASSERT_EQ(outcomes[place].kind, OutcomeKind::kRefused) << place;
    EXPECT_EQ(*outcomes[place].rejection, RateReason());
  }
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kDuplicate);
  EXPECT_EQ(outcomes[4].kind, OutcomeKind::kDuplicate);
  EXPECT_EQ(CursorNow(), 5U);
}

TEST_P(KeptRejectsContract, ARangeOfAHoldThatIsOverIsFenced) {
  Open();
  const storage::CommitRecord stale = Limited(1, 3);
  Open(Request(), kOther);
  EXPECT_THAT(Commit({stale}), ElementsAre(OutcomeKind::kFenced));
  EXPECT_THAT(Open().rejects, IsEmpty());
}

TEST_P(KeptRejectsContract, TheyGoWithTheirSessionAndAreNotThoseOfALaterOneOfItsId) {
  Open();
  Commit({Limited(1, 3), Bad(4)});
  EvictSession();
  EXPECT_THAT(Read(0, 100), IsEmpty());
  EXPECT_THAT(Told(), IsEmpty());
  Commit({Good(1), Limited(2, 3)});
  EXPECT_THAT(Told(), ElementsAre(2, 3));
}

TEST_P(KeptRejectsContract, ThoseOfSessionsThatStayOutliveAnEviction) {
  Open();
  Commit({Limited(1, 3)});
  storage::OpenRequest request = Request();
  request.session = session_ = Session(2);
  request.at = Time(1);
  Open(request);
  Commit({Limited(1, 2), Limited(4, 4)});
  for (std::uint8_t i = 2; i <= storage::kSessionsPerRobotMax; ++i) {
    request.session = Session(static_cast<std::uint8_t>(100 + i));
    request.at = Time(i);
    Open(request);
  }
  EXPECT_THAT(Read(0, 100), ElementsAre(1, 2, 4));
  session_ = Session();
  EXPECT_THAT(Read(0, 100), IsEmpty()) << "the least recently used one went";
}

// A row that stayed would take the place of the later session's.
TEST_P(KeptRejectsContract, ALaterSessionOfItsIdKeepsItsOwn) {
  Fresh();
  Commit({Limited(1, 3)});
  EvictSession();
  Open();
  Commit({Good(1), Bad(3)});
  EXPECT_GT(Retain(15 * kDayMs), 0U);
  EXPECT_THAT(Quarantine(), IsEmpty());
  const storage::OpenResult result = Open();
  ASSERT_THAT(NumbersOf(result.rejects), ElementsAre(3));
  EXPECT_EQ(result.rejects[0].rejection, BadReason());
}

TEST_P(KeptRejectsContract, RejectsThatNoHelloConfirmedOutliveTheirDay) {
  Fresh();
  Commit({Bad(1), Good(2), Bad(3), Limited(4, 5), Bad(6)});
  EXPECT_THAT(Told(1), ElementsAre(3, 4, 5, 6));
  EXPECT_GT(Retain(15 * kDayMs), 0U);
  EXPECT_THAT(Quarantine(), IsEmpty());
  const storage::OpenResult result = OpenSettled(1);
  EXPECT_THAT(NumbersOf(result.rejects), ElementsAre(3, 4, 5, 6));
  EXPECT_EQ(result.rejects_total, 4U);
  EXPECT_EQ(result.rejects[0].rejection, BadReason());
  EXPECT_THAT(Read(1, 6), ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(Commit({Bad(1), Bad(3)}),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kRefused));
  Retain(30 * kDayMs);
  EXPECT_THAT(Told(5), ElementsAre(6));
  EXPECT_THAT(Told(6), IsEmpty());
}

// A slice per call: what waits goes between two of them.
TEST_P(KeptRejectsContract, BetweenTheSlicesOfADayNoneIsMissingAndNoneIsDouble) {
  constexpr model::Seq kSlice = storage::kRetainRowsMax;
  Fresh();
  CommitBad(2 * kSlice + 2);
  const storage::Erased first = RetainOnce(15 * kDayMs);
  EXPECT_EQ(first.rejects_kept, kSlice);
  EXPECT_TRUE(first.more);
  EXPECT_EQ(Open().rejects_total, 2 * kSlice + 2);
  EXPECT_THAT(Read(kSlice - 2, 2 * kSlice, 4),
              ElementsAre(kSlice - 1, kSlice, kSlice + 1, kSlice + 2));
  EXPECT_THAT(Commit({Bad(kSlice), Bad(kSlice + 1), Good(2 * kSlice + 3)}),
              ElementsAre(OutcomeKind::kRefused, OutcomeKind::kRefused, OutcomeKind::kStored));
  // A Hello confirms what was kept, and some that is not yet.
  EXPECT_EQ(OpenSettled(2 * kSlice).rejects_total, 2U);
  std::size_t kept = 0;
  for (bool more = true; more;) {
    const storage::Erased erased = RetainOnce(15 * kDayMs);
    kept += erased.rejects_kept;
    more = erased.more;
  }
  EXPECT_EQ(kept, 2U);
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_THAT(Told(), ElementsAre(2 * kSlice + 1, 2 * kSlice + 2));
}

// The server's clock was behind, or the batch waited for long.
TEST_P(KeptRejectsContract, RowsOfADayThatComeWhileItGoesAreKeptToo) {
  constexpr model::Seq kSlice = storage::kRetainRowsMax;
  Fresh();
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= kSlice + 1; ++seq) records.push_back(At(1'000, Bad(seq, "")));
  Commit(std::move(records));
  EXPECT_TRUE(RetainOnce(15 * kDayMs).more);
  EXPECT_THAT(Commit({At(0, Bad(kSlice + 2))}), ElementsAre(OutcomeKind::kStored));
  while (RetainOnce(15 * kDayMs).more) {
  }
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_EQ(Open().rejects_total, kSlice + 2);
  EXPECT_THAT(Read(kSlice, kSlice + 2), ElementsAre(kSlice + 1, kSlice + 2));
}

TEST_P(KeptRejectsContract, SoDoThoseOfADayForWhichNoStoreMadeRoom) {
  Fresh();
  const std::int64_t old = -200 * kDayMs;
  Commit({At(old, Bad(1)), At(old, Bad(2))});
  EXPECT_GT(Retain(0), 0U);
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_THAT(Told(1), ElementsAre(2));
}

TEST_P(KeptRejectsContract, ThoseOfASessionThatIsNotKeptDoNot) {
  Fresh();
  Commit({Bad(1)});
  EvictSession();
  EXPECT_GT(Retain(15 * kDayMs), 0U);
  EXPECT_THAT(Told(), IsEmpty());
  EXPECT_THAT(Read(0, 100), IsEmpty());
}

TEST_P(KeptRejectsContract, AsManyAsOneSessionMayHaveOutliveTheirDay) {
  Fresh();
  CommitBad(storage::kQuarantineRowsPerRobotMax);
  std::size_t kept = 0;
  for (bool more = true; more;) {
    const storage::Erased erased = RetainOnce(15 * kDayMs);
    EXPECT_LE(erased.rejects_kept, storage::kRetainRowsMax);
    kept += erased.rejects_kept;
    more = erased.more;
  }
  EXPECT_EQ(kept, storage::kQuarantineRowsPerRobotMax);
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_EQ(Open().rejects_total, storage::kQuarantineRowsPerRobotMax);
  EXPECT_THAT(
      Read(storage::kQuarantineRowsPerRobotMax - 2, storage::kQuarantineRowsPerRobotMax),
      ElementsAre(storage::kQuarantineRowsPerRobotMax - 1, storage::kQuarantineRowsPerRobotMax));
}

INSTANTIATE_TEST_SUITE_P(Stores, KeptRejectsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
