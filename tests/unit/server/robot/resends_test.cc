#include "server/robot/resends.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

using storage::BitOf;
using storage::kAllLatestKinds;
using storage::LatestKind;

constexpr storage::LatestKindSet kInfo = BitOf(LatestKind::kAgentInfo);
constexpr storage::LatestKindSet kSettings = BitOf(LatestKind::kSettings);
constexpr SteadyTime kStart{std::chrono::hours(1)};

class ResendsTest : public ::testing::Test {
 protected:
  void Answer(storage::LatestKindSet held, bool waits = false) {
    resends_.Answer(held, [waits](const SentMessage&) { return waits; });
  }
  Resends resends_;
};

TEST_F(ResendsTest, NothingIsKnownBeforeTheStoreAnswers) {
  resends_.Begin();
  EXPECT_EQ(resends_.view().missing, 0U);
  const Resends::Due due = resends_.Take(kStart);
  EXPECT_EQ(due.kinds, 0U);
  EXPECT_FALSE(due.next);
}

TEST_F(ResendsTest, EachKindIsAskedForOnceInItsTime) {
  Answer(kAllLatestKinds & ~kInfo);
  EXPECT_EQ(resends_.Take(kStart).kinds, kInfo);
  Answer(kAllLatestKinds & ~(kInfo | kSettings));
  const Resends::Due later = resends_.Take(kStart + std::chrono::seconds(1));
  EXPECT_EQ(later.kinds, kSettings);
  EXPECT_EQ(later.next, kStart + kResendEvery) << "that of the other kind";
  EXPECT_EQ(resends_.Take(kStart + kResendEvery - milliseconds(1)).kinds, 0U);
  EXPECT_EQ(resends_.Take(kStart + kResendEvery).kinds, kInfo);
}

TEST_F(ResendsTest, OneThatCameWhileTheStoreWasAskedIsNotMissingIfItWaits) {
  resends_.Begin();
  resends_.AddGood(LatestKind::kSettings, {.session = {}, .seq = 7});
  Answer(0, true);
  EXPECT_EQ(resends_.view().missing, kAllLatestKinds & ~kSettings);
  Answer(0, false);
  EXPECT_EQ(resends_.view().missing, kAllLatestKinds) << "it was settled, and is not there";
}

TEST_F(ResendsTest, AnAnswerCountsUntilTheStoreLacksTheKindAgain) {
  Answer(0);
  EXPECT_EQ(resends_.view().unanswered, 0U);
  EXPECT_EQ(resends_.Take(kStart).kinds, kAllLatestKinds);
  EXPECT_EQ(resends_.view().unanswered, kAllLatestKinds);
  resends_.AddGood(LatestKind::kAgentInfo, {.session = {}, .seq = 1});
  EXPECT_EQ(resends_.view().unanswered, kAllLatestKinds & ~kInfo);
  resends_.Begin();
  EXPECT_EQ(resends_.view().unanswered, 0U);
  Answer(0);
  EXPECT_EQ(resends_.view().missing, kAllLatestKinds);
  EXPECT_EQ(resends_.view().unanswered, kAllLatestKinds & ~kInfo) << "not asked since it came";
  EXPECT_EQ(resends_.Take(kStart + std::chrono::seconds(1)).kinds, 0U) << "but it is too soon";
}

}  // namespace
}  // namespace uplink::robot
