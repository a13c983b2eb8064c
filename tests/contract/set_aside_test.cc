#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST_P(StoreContract, KeepsARejectedPayloadWithItsReason) {
  Open();
  const std::string payload("\x00\x01'\xFF", 4);
  storage::CommitRecord record = Bad(4, payload);
  record.payload_bytes = 300'000;
  EXPECT_THAT(Commit({record}), ElementsAre(OutcomeKind::kStored));
  const auto rows = Quarantine();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].robot, *robot_);
  EXPECT_EQ(rows[0].session, session_);
  EXPECT_EQ(rows[0].seq, 4);
  EXPECT_EQ(rows[0].rejection, BadReason());
  EXPECT_EQ(rows[0].received_at, Time());
  EXPECT_EQ(rows[0].payload, payload);
  EXPECT_EQ(rows[0].payload_bytes, 300'000);
  EXPECT_EQ(CursorNow(), 4);
}

TEST_P(StoreContract, KeepsEveryReasonAndTheLongestDetail) {
  Open();
  std::vector<storage::CommitRecord> records;
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    storage::CommitRecord record = Bad(records.size() + 1);
    record.content =
        storage::QuarantineItem{{reason, "kv[3].key", std::string(model::kDetailBytesMax, 'd')}};
    records.push_back(record);
  }
  Commit(records);
  const auto rejects = Open().rejects;
  ASSERT_THAT(rejects, SizeIs(model::kRejectReasons));
  for (std::size_t i = 0; i < rejects.size(); ++i) {
    EXPECT_EQ(rejects[i].rejection,
              std::get<storage::QuarantineItem>(records[i].content).rejection);
  }
}

TEST_P(StoreContract, RefusesASecondCopyOfARejectedNumberInOneBatch) {
  Open();
  storage::Batch batch;
  batch.records = {Bad(1), Bad(1), Good(1, Fault("f"))};
  const auto outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(3));
  EXPECT_EQ(outcomes[0].kind, OutcomeKind::kStored);
  ASSERT_EQ(outcomes[1].kind, OutcomeKind::kRefused);
  EXPECT_EQ(*outcomes[1].rejection, BadReason());
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kRefused);
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(History(), SizeIs(0));
}

TEST_P(StoreContract, DropsTheOldestPayloadsPastTheBoundAndKeepsTheirRows) {
  Open();
  OpenAlso({Robot("b")});
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= storage::kQuarantinePayloadsPerRobotMax; ++seq) {
    records.push_back(Bad(seq));
  }
  Commit(std::move(records));
  const auto with_payload = [this] {
    storage::HistoryQuery query;
    query.page_size = storage::kPageSizeMax;
    std::size_t count = 0;
    std::string token;
    do {
      query.page_token = token;
      const auto page = store_->reader().Quarantine({.rows = query});
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return count;
      for (const auto& row : page->rows)
        if (!row.payload.empty()) ++count;
      token = page->next_token;
    } while (!token.empty());
    return count;
  };
  EXPECT_EQ(with_payload(), storage::kQuarantinePayloadsPerRobotMax);

  // A thinned one and another robot's do not count.
  storage::CommitRecord other_robot = Bad(1);
  other_robot.robot = Robot("b");
  Commit({Bad(5'000, ""), other_robot});
  EXPECT_EQ(with_payload(), storage::kQuarantinePayloadsPerRobotMax + 1);
  Commit({Bad(5'001), Bad(5'002)});
  EXPECT_EQ(with_payload(), storage::kQuarantinePayloadsPerRobotMax + 1);

  const storage::OpenResult result = Open();
  EXPECT_EQ(result.rejects_total, storage::kQuarantinePayloadsPerRobotMax + 3);
  EXPECT_EQ(result.rejects.front().rejection, BadReason());
  storage::HistoryQuery oldest;
  oldest.page_size = storage::kPageSizeMax;
  oldest.ruris = {robot_->ruri};
  const auto first = store_->reader().Quarantine({.rows = oldest});
  ASSERT_TRUE(first.ok()) << first.status();
  oldest.page_token = first->next_token;
  const auto rows = Quarantine(oldest);
  ASSERT_THAT(rows, SizeIs(3));
  EXPECT_EQ(rows[2].seq, 1);
  EXPECT_EQ(rows[2].payload, "");
  EXPECT_EQ(rows[1].payload, "");
  EXPECT_EQ(rows[0].payload, "bad bytes");
  EXPECT_EQ(rows[2].payload_bytes, 9);
}

TEST_P(StoreContract, WritesAGapOnce) {
  Open();
  CommitGaps({Gap(3, 5), Gap(9, 9)});
  storage::GapItem again = Gap(3, 7);
  again.seen_at = Time(40);
  CommitGaps({again, Gap(3, 4)});
  const auto rows = Gaps();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].first, 9);
  EXPECT_EQ(rows[1].first, 3);
  EXPECT_EQ(rows[1].last, 7);
  EXPECT_EQ(rows[1].seen_at, Time());
  EXPECT_EQ(rows[1].robot, *robot_);
  EXPECT_EQ(rows[1].session, session_);
  EXPECT_EQ(CursorNow(), 0) << "a gap has no number";
}

TEST_P(StoreContract, KeysGapsBySessionToo) {
  Open();
  storage::GapItem other = Gap(3, 5);
  other.session = Session(2);
  CommitGaps({Gap(3, 5), other});
  EXPECT_THAT(Gaps(), SizeIs(2));
}

TEST_P(StoreContract, BoundsTheGapsOfARobot) {
  Open();
  std::vector<storage::GapItem> gaps;
  for (model::Seq i = 1; i <= storage::kGapsPerRobotMax; ++i) {
    gaps.push_back(Gap(2 * i, 2 * i));
    gaps.back().seen_at = Time(static_cast<std::int64_t>(i));
  }
  CommitGaps(gaps);
  const auto at_first = [this] {
    storage::HistoryQuery query;
    query.to = Time(1);
    return Gaps(query);
  };
  EXPECT_THAT(at_first(), SizeIs(1));
  storage::GapItem more = Gap(model::kSeqMax - 1, model::kSeqMax);
  more.seen_at = Time(1'000'000);
  storage::GapItem other_robot = Gap(1, 1);
  other_robot.robot = Robot("b");
  other_robot.seen_at = Time(1'000'000);
  CommitGaps({other_robot});
  EXPECT_THAT(at_first(), SizeIs(1));
  CommitGaps({more});
  EXPECT_THAT(at_first(), SizeIs(0));
  storage::HistoryQuery query;
  query.page_size = 2;
  const auto newest = Gaps(query);
  ASSERT_THAT(newest, SizeIs(2));
  EXPECT_EQ(newest[0].last, model::kSeqMax);
}

}  // namespace
}  // namespace uplink::testing
