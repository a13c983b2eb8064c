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
  EXPECT_THAT(Seqs(memory.TellAgain(2, {})), ElementsAre(5, 7));
}

TEST(RejectMemoryTest, WhatTheStoreRefusedIsToldOnceAndRepeated) {
  RejectMemory memory;
  memory.AddUntold(Rejected(3));
  EXPECT_THAT(Seqs(memory.TakeUntold()), ElementsAre(3));
  EXPECT_THAT(memory.TakeUntold(), IsEmpty());
  EXPECT_THAT(Seqs(memory.TellAgain(0, {})), ElementsAre(3));
}

TEST(RejectMemoryTest, ARepetitionTellsTheUntoldToo) {
  RejectMemory memory;
  memory.AddUntold(Rejected(3));
  EXPECT_THAT(Seqs(memory.TellAgain(0, {})), ElementsAre(3));
  EXPECT_THAT(memory.TakeUntold(), IsEmpty());
}

TEST(RejectMemoryTest, WhatIsRememberedWinsOverTheStoresAndDoublesAreLeftOut) {
  RejectMemory memory;
  memory.Remember(Rejected(3, "ours"));
  const auto again = memory.TellAgain(0, {Rejected(2, "the store's"), Rejected(3, "the store's")});
  ASSERT_THAT(again, SizeIs(2));
  EXPECT_EQ(again[0].rejection.detail, "the store's");
  EXPECT_EQ(again[1].rejection.detail, "ours");
}

TEST(RejectMemoryTest, TheStoresAreRememberedForTheNextWelcome) {
  RejectMemory memory;
  static_cast<void>(memory.TellAgain(9, {Rejected(4)}));
  EXPECT_THAT(Seqs(memory.TellAgain(0, {})), ElementsAre(4));
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
  static_cast<void>(memory.TellAgain(3, {Rejected(2), Rejected(4), Rejected(5)}));
  EXPECT_EQ(memory.unconfirmed(), 2U) << "4 and 5";
  memory.Remember(Rejected(9));
  EXPECT_EQ(memory.unconfirmed(), 3U);
  static_cast<void>(memory.TellAgain(9, {}));
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
  EXPECT_THAT(memory.TellAgain(0, {}), SizeIs(kRejectsRememberedMax));
  memory.Remember(Rejected(kRejectsRememberedMax + 1));
  const auto again = memory.TellAgain(0, {});
  EXPECT_THAT(again, SizeIs(kRejectsRememberedMax));
  EXPECT_EQ(again.front().seq, 2U);
}

}  // namespace
}  // namespace uplink::robot
