#include <algorithm>
#include <utility>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

/// Rows of quarantine per robot.
namespace uplink::testing {
namespace {

using model::RejectReason;
using storage::DroppedRow;
using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class QuarantineBoundContract : public StoreContract {
 protected:
  static storage::CommitRecord For(RejectReason reason, storage::CommitRecord record) {
    record.content = storage::QuarantineItem{{reason, "", ""}};
    return record;
  }
  /// Rows of the fixture's session without payloads, numbers `first` to `last`.
  void Fill(model::Seq first, model::Seq last, RejectReason reason = RejectReason::kMalformed) {
    std::vector<storage::CommitRecord> records;
    for (model::Seq seq = first; seq <= last; ++seq) {
      records.push_back(For(reason, Bad(seq, "")));
    }
    Commit(std::move(records));
  }
  storage::Trimmed Trim(const std::vector<std::string>& ruris) {
    const auto trimmed = store_->Process(kProcess).TrimQuarantine(ruris);
    EXPECT_TRUE(trimmed.ok()) << trimmed.status();
    return trimmed.value_or(storage::Trimmed());
  }
  /// How many rows went.
  std::size_t Trim() {
    const storage::Trimmed trimmed = Trim({robot_->ruri});
    std::size_t went = 0;
    for (const std::size_t rows : trimmed.dropped) went += rows;
    EXPECT_EQ(trimmed.unfinished.size(), went == storage::kTrimRowsMax ? 1U : 0U);
    return went;
  }
  std::vector<DroppedRow> Dropped(const std::string& ruri) {
    const auto rows = store_->reader().QuarantineDropped(ruri);
    EXPECT_TRUE(rows.ok()) << rows.status();
    return rows.value_or(std::vector<DroppedRow>());
  }
  /// All numbers of the robot's rows, ascending.
  std::vector<model::Seq> Numbers() {
    storage::HistoryQuery query;
    query.ruris = {robot_->ruri};
    query.page_size = storage::kPageSizeMax;
    std::vector<model::Seq> numbers;
    do {
      const auto page = store_->reader().Quarantine({.rows = query});
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return numbers;
      for (const auto& row : page->rows) numbers.push_back(row.seq);
      query.page_token = page->next_token;
    } while (!query.page_token.empty());
    std::ranges::sort(numbers);
    return numbers;
  }

  static constexpr model::Seq kMax = storage::kQuarantineRowsPerRobotMax;
};

TEST_P(QuarantineBoundContract, AtTheBoundNothingGoes) {
  Open();
  Fill(1, kMax);
  EvictSession();
  EXPECT_EQ(Trim(), 0U);
  EXPECT_THAT(Numbers(), SizeIs(kMax));
  EXPECT_THAT(Dropped(robot_->ruri), IsEmpty());
}

TEST_P(QuarantineBoundContract, PastItTheOldestOfSessionsThatAreNotKeptGo) {
  Open();
  Fill(1, 2, RejectReason::kOutOfRange);
  Fill(3, kMax);
  EvictSession();
  // A session that is kept, with numbers of its own.
  session_ = Session(101);
  Fill(kMax + 1, kMax + 3);
  EXPECT_EQ(Trim(), 3U);
  const std::vector<model::Seq> left = Numbers();
  ASSERT_THAT(left, SizeIs(kMax));
  EXPECT_EQ(left.front(), 4U);
  EXPECT_EQ(left.back(), kMax + 3);
  EXPECT_THAT(Dropped(robot_->ruri), ElementsAre(DroppedRow{RejectReason::kMalformed, 1},
                                                 DroppedRow{RejectReason::kOutOfRange, 2}));
  EXPECT_EQ(Trim(), 0U);
  Fill(kMax + 4, kMax + 4);
  EXPECT_EQ(Trim(), 1U);
  EXPECT_THAT(Dropped(robot_->ruri), ElementsAre(DroppedRow{RejectReason::kMalformed, 2},
                                                 DroppedRow{RejectReason::kOutOfRange, 2}));
}

TEST_P(QuarantineBoundContract, RowsOfAKeptSessionThatNobodyConfirmedStay) {
  Open();
  Fill(1, kMax + 10);
  EXPECT_EQ(Trim(), 0U);
  EXPECT_THAT(Numbers(), SizeIs(kMax + 10));
  storage::OpenRequest request = Request();
  request.rejects_max = kMax + 20;
  EXPECT_THAT(Open(request).rejects, SizeIs(kMax + 10));
}

TEST_P(QuarantineBoundContract, RowsThatAHelloConfirmedGoAfterThoseOfSessionsNotKept) {
  Open();
  Fill(1, 5);
  EvictSession();
  session_ = Session(101);
  Fill(1'000, kMax + 1'004);
  storage::OpenRequest request = Request();
  request.settled_seq = 1'003;
  request.at = Time(100);
  Open(request);
  // 10,010 rows: five of the session that is not kept, and four that are confirmed.
  EXPECT_EQ(Trim(), 9U);
  EXPECT_EQ(Numbers().front(), 1'004U);
  request.settled_seq = 0;
  EXPECT_EQ(Open(request).rejects.front().seq, 1'004U) << "a number once settled stays so";
  EXPECT_EQ(Trim(), 0U);
  request.settled_seq = 2'000;
  Open(request);
  EXPECT_EQ(Trim(), 1U) << "down to the bound, and no further";
  EXPECT_EQ(Numbers().front(), 1'005U);
}

TEST_P(QuarantineBoundContract, WhatIsSettledAboveTheCursorConfirmsNothingToCome) {
  Open();
  storage::OpenRequest request = Request();
  request.settled_seq = model::kSeqMax;
  Open(request);
  Fill(1, kMax + 1);
  EXPECT_EQ(Trim(), 0U);
}

TEST_P(QuarantineBoundContract, RowsFromBeforeASessionBeganAnewAreThoseOfNone) {
  Open();
  Fill(1, 7);
  EvictSession();
  Open();  // as if it was never there
  Fill(8, kMax + 2);
  EXPECT_EQ(Trim(), 2U);
  EXPECT_EQ(Numbers().front(), 3U);
}

TEST_P(QuarantineBoundContract, ANumberWhoseRowWentIsADuplicate) {
  Open();
  Fill(1, kMax + 1);
  storage::OpenRequest request = Request();
  request.settled_seq = 5;
  Open(request);
  EXPECT_EQ(Trim(), 1U);
  EXPECT_THAT(Commit({Bad(1), Bad(2)}),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kRefused));
}

TEST_P(QuarantineBoundContract, ACallDeletesABoundedNumberOfRowsOfEachRobot) {
  Open();
  Fill(1, kMax + storage::kTrimRowsMax + 1);
  EvictSession();
  const storage::Trimmed first = Trim({Robot("b")->ruri, robot_->ruri, Robot("c")->ruri});
  EXPECT_THAT(first.unfinished, ElementsAre(1U));
  EXPECT_EQ(first.dropped[static_cast<std::size_t>(RejectReason::kMalformed)],
            storage::kTrimRowsMax);
  EXPECT_EQ(Trim(), 1U);
  EXPECT_THAT(Dropped(robot_->ruri),
              ElementsAre(DroppedRow{RejectReason::kMalformed, storage::kTrimRowsMax + 1}));
  EXPECT_THAT(Dropped(Robot("b")->ruri), IsEmpty());
}

TEST_P(QuarantineBoundContract, ACallThatFailsDropsAndCountsNothing) {
  Open();
  Fill(1, kMax + 1);
  EvictSession();
  store_->FailNextWrite(kProcess);
  const std::vector<std::string> ruris = {robot_->ruri};
  EXPECT_FALSE(store_->Process(kProcess).TrimQuarantine(ruris).ok());
  EXPECT_THAT(Numbers(), SizeIs(kMax + 1));
  EXPECT_THAT(Dropped(robot_->ruri), IsEmpty());
  EXPECT_EQ(Trim(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Stores, QuarantineBoundContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
