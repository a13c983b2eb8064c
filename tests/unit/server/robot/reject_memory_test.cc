#include "server/robot/reject_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

RejectedSeq Rejected(model::Seq seq, std::string detail = "") {
  return {.seq = seq,
          .rejection = {.reason = model::RejectReason::kMalformed, .detail = std::move(detail)}};
}

std::vector<model::Seq> Seqs(const std::vector<RejectedSeq>& rejects) {
  std::vector<model::Seq> seqs;
  seqs.reserve(rejects.size());
  for (const RejectedSeq& rejected : rejects) seqs.push_back(rejected.seq);
  return seqs;
}

TEST(RejectMemoryTest, RepeatsWhatIsAboveTheSettledNumberInOrder) {
  RejectMemory memory;
  for (const model::Seq seq : {7U, 2U, 5U}) memory.Remember(Rejected(seq));
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(2, {})), ElementsAre(5, 7));
}

TEST(RejectMemoryTest, WhatTheStoreRefusedIsToldOnceAndRepeated) {
  RejectMemory memory;
  memory.AddUntold(Rejected(3));
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(3));
  EXPECT_THAT(memory.TakeUntold(), IsEmpty());
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(0, {})), ElementsAre(3));
}

TEST(RejectMemoryTest, ARepetitionTellsTheUntoldToo) {
  RejectMemory memory;
  memory.AddUntold(Rejected(3));
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(0, {})), ElementsAre(3));
  EXPECT_THAT(memory.TakeUntold(), IsEmpty());
}

TEST(RejectMemoryTest, WhatIsRememberedWinsOverTheStoresAndDoublesAreLeftOut) {
  RejectMemory memory;
  memory.Remember(Rejected(3, "ours"));
  const auto again =
      memory.RepeatForWelcome(0, {Rejected(2, "the store's"), Rejected(3, "the store's")});
  ASSERT_THAT(again, SizeIs(2));
  EXPECT_EQ(again[0].rejection.detail, "the store's");
  EXPECT_EQ(again[1].rejection.detail, "ours");
}

TEST(RejectMemoryTest, TheStoresAreRememberedForTheNextWelcome) {
  RejectMemory memory;
  static_cast<void>(memory.RepeatForWelcome(9, {Rejected(4)}));
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(0, {})), ElementsAre(4));
}

TEST(RejectMemoryTest, CountsWhatWasToldAndIsNotConfirmed) {
  RejectMemory memory;
  EXPECT_EQ(memory.unconfirmed(), 0U);
  memory.Remember(Rejected(3));
  memory.Remember(Rejected(3));
  memory.AddUntold(Rejected(5));
  EXPECT_EQ(memory.unconfirmed(), 2U);
  static_cast<void>(memory.TakeUntold());
  EXPECT_EQ(memory.unconfirmed(), 2U) << "told is not confirmed";
  static_cast<void>(memory.RepeatForWelcome(3, {Rejected(2), Rejected(4), Rejected(5)}));
  EXPECT_EQ(memory.unconfirmed(), 2U) << "4 and 5";
  memory.Remember(Rejected(9));
  EXPECT_EQ(memory.unconfirmed(), 3U);
  static_cast<void>(memory.RepeatForWelcome(9, {}));
  EXPECT_EQ(memory.unconfirmed(), 0U);
}

TEST(RejectMemoryTest, CountsOnWhereItForgets) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax + 5; ++seq) memory.Remember(Rejected(seq));
  EXPECT_EQ(memory.unconfirmed(), kRejectsRememberedMax + 5);
  memory.AddUntold(Rejected(5));
  EXPECT_EQ(memory.unconfirmed(), kRejectsRememberedMax + 5) << "sent again, and counted before";
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(5)) << "the stream is told all the same";
}

TEST(RejectMemoryTest, PastTheBoundTheLowestNumberIsForgotten) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax; ++seq) memory.Remember(Rejected(seq));
  EXPECT_THAT(memory.RepeatForWelcome(0, {}), SizeIs(kRejectsRememberedMax));
  memory.Remember(Rejected(kRejectsRememberedMax + 1));
  const auto again = memory.RepeatForWelcome(0, {});
  EXPECT_THAT(again, SizeIs(kRejectsRememberedMax));
  EXPECT_EQ(again.front().seq, 2U);
}

TEST(RejectMemoryTest, WhatItLetGoIsAwaitedAboveWhatTheAgentConfirmed) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax; ++seq) memory.Remember(Rejected(seq));
  EXPECT_FALSE(memory.AwaitLate(0, 0)) << "it has all";
  memory.Remember(Rejected(kRejectsRememberedMax + 1));
  EXPECT_FALSE(memory.AwaitLate(1, 1)) << "the agent confirmed what it lacks";
  EXPECT_FALSE(memory.told_through().has_value());
  EXPECT_TRUE(memory.AwaitLate(0, 0));
  EXPECT_EQ(memory.told_through(), 0U);
}

TEST(RejectMemoryTest, WhatComesLateIsUntoldUnlessItIsRemembered) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax + 2; ++seq) memory.Remember(Rejected(seq));
  static_cast<void>(memory.RepeatForWelcome(0, {}));
  ASSERT_TRUE(memory.AwaitLate(0, 0));
  memory.AddLate({Rejected(1), Rejected(2), Rejected(3)});
  EXPECT_FALSE(memory.told_through().has_value());
  EXPECT_EQ(memory.unconfirmed(), kRejectsRememberedMax + 2);
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(1, 2));
  memory.AddLate({Rejected(1)});
  EXPECT_THAT(memory.TakeUntold(), IsEmpty()) << "it is not awaited";
}

TEST(RejectMemoryTest, ARepetitionAwaitsNothing) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax + 1; ++seq) memory.Remember(Rejected(seq));
  ASSERT_TRUE(memory.AwaitLate(0, 0));
  EXPECT_THAT(memory.RepeatForWelcome(0, {Rejected(1)}), SizeIs(kRejectsRememberedMax + 1));
  EXPECT_FALSE(memory.told_through().has_value());
}

TEST(RejectMemoryTest, PagesAreToldOnceAndMergedWithWhatItHas) {
  RejectMemory memory;
  memory.Remember(Rejected(6));
  memory.Remember(Rejected(12));
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(0, {Rejected(2)})), ElementsAre(2, 6, 12));
  memory.BeginPages({.after = 2, .through = 9}, 4);
  EXPECT_EQ(memory.unconfirmed(), 6U) << "6 is one of the four";
  EXPECT_EQ(memory.told_through(), 2U);
  memory.AddPage({Rejected(4), Rejected(6)}, 6);
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(4)) << "6 was told";
  EXPECT_EQ(memory.told_through(), 6U);
  EXPECT_EQ(memory.unread(9)->after, 6U);
  memory.AddPage({Rejected(7), Rejected(8)}, 9);
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(7, 8));
  EXPECT_FALSE(memory.told_through().has_value());
  EXPECT_FALSE(memory.has_unread());
}

TEST(RejectMemoryTest, WhatItIsToldOnlyByPagesIsAwaitedTheNextTime) {
  RejectMemory memory;
  static_cast<void>(memory.RepeatForWelcome(0, {Rejected(2)}));
  memory.BeginPages({.after = 2, .through = 9}, 1);
  memory.AddPage({Rejected(7)}, 9);
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(7));
  EXPECT_THAT(Seqs(memory.RepeatForWelcome(0, {})), ElementsAre(2));
  EXPECT_TRUE(memory.AwaitLate(0, 0));
  EXPECT_FALSE(memory.AwaitLate(9, 9));
}

TEST(RejectMemoryTest, WhatItLetGoOfIsReadOnceItIsCommitted) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax + 10; ++seq) memory.Remember(Rejected(seq));
  // The memory let go of 1 to 10. The store's cursor is 4, so 5 to 10 wait for their commit.
  static_cast<void>(memory.RepeatForWelcome(2, {Rejected(3), Rejected(4)}));
  memory.BeginPages({.after = 4, .through = 4}, 0);
  EXPECT_EQ(memory.told_through(), 4U);
  EXPECT_TRUE(memory.has_unread());
  EXPECT_FALSE(memory.unread(9).has_value());
  ASSERT_TRUE(memory.unread(10).has_value());
  EXPECT_EQ(memory.unread(10)->after, 4U);
  EXPECT_EQ(memory.unread(10)->through, 10U);
  const std::size_t before = memory.unconfirmed();
  std::vector<RejectedSeq> page;
  for (model::Seq seq = 5; seq <= 10; ++seq) page.push_back(Rejected(seq));
  memory.AddPage(std::move(page), 10);
  EXPECT_EQ(memory.unconfirmed(), before + 6) << "no answer counted them";
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(5, 6, 7, 8, 9, 10));
  EXPECT_FALSE(memory.told_through().has_value());
}

TEST(RejectMemoryTest, WhatItLetGoOfAndAHelloConfirmedIsNotRead) {
  RejectMemory memory;
  for (model::Seq seq = 1; seq <= kRejectsRememberedMax + 10; ++seq) memory.Remember(Rejected(seq));
  static_cast<void>(memory.RepeatForWelcome(10, {}));
  memory.BeginPages({.after = 4, .through = 4}, 0);
  EXPECT_FALSE(memory.told_through().has_value());
}

TEST(RejectMemoryTest, LiveNumbersThatWereLimitedAreInNoPage) {
  RejectMemory memory;
  memory.RememberLive({.seq = 5, .rejection = {.reason = model::RejectReason::kRateLimited}});
  static_cast<void>(memory.RepeatForWelcome(0, {Rejected(2)}));
  memory.BeginPages({.after = 2, .through = 9}, 1);
  EXPECT_EQ(memory.unconfirmed(), 2U) << "it need not be confirmed, nor does it stand for one";
}

TEST(RejectMemoryTest, ANewOneAwaitsTheStoreIfTheAgentKnowsOfMore) {
  RejectMemory memory;
  static_cast<void>(memory.RepeatForWelcome(4, {}));
  EXPECT_FALSE(memory.AwaitLate(4, 4)) << "what comes is judged on this stream";
  EXPECT_TRUE(memory.AwaitLate(4, 9)) << "another process may have rejected 5 to 9";
  EXPECT_EQ(memory.told_through(), 4U);
  memory.AddLate({Rejected(6)});
  EXPECT_FALSE(memory.told_through());
  EXPECT_THAT(memory.TakeUntold(), SizeIs(1));
  static_cast<void>(memory.RepeatForWelcome(4, {}));
  EXPECT_FALSE(memory.AwaitLate(4, 9)) << "it knows all since";
}

TEST(RejectMemoryTest, NothingThatPagesHoldIsCalledJudgedUntilItIsTold) {
  RejectMemory memory;
  static_cast<void>(memory.RepeatForWelcome(0, {Rejected(2)}));
  EXPECT_FALSE(memory.judged_through(0));
  memory.BeginPages({.after = 2, .through = 9}, 3);
  EXPECT_EQ(memory.judged_through(0), 2U);
  EXPECT_EQ(memory.judged_through(5), 5U);
  EXPECT_FALSE(memory.judged_through(9)) << "the agent knows that already";
  memory.AddPage({Rejected(3), Rejected(6)}, 6);
  EXPECT_EQ(memory.judged_through(5), 6U);
  memory.AddPage({Rejected(8)}, 9);
  EXPECT_FALSE(memory.judged_through(0));
}

}  // namespace
}  // namespace uplink::robot
