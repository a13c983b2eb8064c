#include "server/robot/outcome.h"

#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const model::Rejection kNoRoom{model::RejectReason::kStoreRefused, "", "no room"};

class OutcomeTest : public ::testing::Test {
 protected:
  void Apply(storage::Outcome outcome,
             std::optional<model::RejectReason> rejected_for = std::nullopt) {
    ApplyOutcome({.seq = 4, .outcome = std::move(outcome), .rejected_for = rejected_for}, 1,
                 rejects_, counts_);
  }
  std::uint64_t CountOf(model::RejectReason reason) const {
    return counts_.rejects[static_cast<std::size_t>(reason)];
  }

  RejectMemory rejects_;
  metrics::MessageCounts counts_;
};

TEST_F(OutcomeTest, AStoredRecordCountsAsStored) {
  Apply({storage::OutcomeKind::kStored});
  EXPECT_EQ(counts_.stored, 1U);
  EXPECT_THAT(rejects_.TakeUntold(), IsEmpty());
}

TEST_F(OutcomeTest, ARangeOfLimitedNumbersCountsEachOfThem) {
  ApplyOutcome({.seq = 9, .first = 4, .rejected_for = model::RejectReason::kRateLimited}, 6,
               rejects_, counts_);
  EXPECT_EQ(counts_.rejected, 6U);
  EXPECT_EQ(CountOf(model::RejectReason::kRateLimited), 6U);
  EXPECT_THAT(rejects_.TakeUntold(), IsEmpty()) << "each was told when it was limited";
}

TEST_F(OutcomeTest, ALimitedNumberThatTheStoreKnowsIsToldWithATime) {
  Apply({storage::OutcomeKind::kRefused, model::Rejection{model::RejectReason::kRateLimited}});
  const auto untold = rejects_.TakeUntold();
  ASSERT_THAT(untold, SizeIs(1));
  EXPECT_EQ(untold[0].retry_after_ms, kStoredRetryAfterMs);
}

TEST_F(OutcomeTest, ADuplicateCountsAsOne) {
  Apply({storage::OutcomeKind::kDuplicate});
  EXPECT_EQ(counts_.duplicate, 1U);
}

TEST_F(OutcomeTest, AStoredQuarantineItemCountsAsRejectedForItsOwnReason) {
  Apply({storage::OutcomeKind::kStored}, model::RejectReason::kMalformed);
  EXPECT_EQ(counts_.stored, 0U);
  EXPECT_EQ(counts_.rejected, 1U);
  EXPECT_EQ(CountOf(model::RejectReason::kMalformed), 1U);
}

TEST_F(OutcomeTest, ARefusalBecomesARejectThatIsToTell) {
  Apply({storage::OutcomeKind::kRefused, kNoRoom});
  EXPECT_EQ(CountOf(model::RejectReason::kStoreRefused), 1U);
  const auto untold = rejects_.TakeUntold();
  ASSERT_THAT(untold, SizeIs(1));
  EXPECT_EQ(untold[0].seq, 4U);
  EXPECT_EQ(untold[0].rejection.detail, "no room");
}

TEST_F(OutcomeTest, ARefusedQuarantineItemWasToldAlready) {
  Apply({storage::OutcomeKind::kRefused, kNoRoom}, model::RejectReason::kMalformed);
  EXPECT_EQ(CountOf(model::RejectReason::kMalformed), 1U);
  EXPECT_THAT(rejects_.TakeUntold(), IsEmpty());
}

}  // namespace
}  // namespace uplink::robot
