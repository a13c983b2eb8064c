#include "server/uncrew/waiting_samples.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::uncrew {
namespace {

using storage::OutcomeKind;

constexpr std::uint32_t kType = 3;

class WaitingSamplesTest : public ::testing::Test {
 protected:
  TicketRef Add(std::uint8_t digest, std::size_t records = 1, bool timed = true,
                std::optional<model::RejectReason> rejected = std::nullopt) {
    std::vector<storage::CommitRecord> made(
        records, {.content = model::OperatorRequest{}, .payload = "", .payload_bytes = 0});
    return waiting_.Add(std::make_shared<const storage::SampleMark>(
                            storage::SampleMark{.type = kType, .digest = {digest}, .timed = timed}),
                        made, rejected);
  }
  /// The next number has this outcome.
  WaitingSamples::Settling Settle(OutcomeKind kind) {
    robot::Settled settled;
    settled.seq = ++settled_;
    settled.outcome.kind = kind;
    if (kind == OutcomeKind::kRefused) {
      settled.outcome.rejection =
          model::Rejection{.reason = model::RejectReason::kTooManyItems, .field = {}, .detail = {}};
    }
    return waiting_.Settle({&settled, 1});
  }
  /// As one more call that asks.
  TicketRef Ask() {
    TicketRef ticket = waiting_.Ask();
    ticket->callers.push_back({});
    return ticket;
  }
  void AddQuestion() {
    ASSERT_TRUE(waiting_.HasDueQuestion());
    std::vector<storage::CommitRecord> question(
        1, {.content = model::OperatorRequest{}, .payload = "", .payload_bytes = 0});
    question.front().sample =
        std::make_shared<const storage::SampleMark>(storage::SampleMark{.is_question = true});
    waiting_.AddQuestion(question);
  }
  [[nodiscard]] TicketRef Find(std::uint8_t digest) const {
    const storage::SampleDigest whole{digest};
    return waiting_.Find(kType, &whole);
  }

  robot::Calls calls_;
  WaitingSamples waiting_{calls_};
  model::Seq settled_ = 0;
};

TEST_F(WaitingSamplesTest, ASampleIsCommittedWithTheLastOfItsRecords) {
  const TicketRef ticket = Add(1, 3);
  EXPECT_EQ(Settle(OutcomeKind::kStored).counts.stored, 0U);
  EXPECT_EQ(Settle(OutcomeKind::kStored).counts.stored, 0U);
  EXPECT_EQ(ticket->state, Ticket::State::kWaiting);
  EXPECT_EQ(calls_.waiting().records, 3U);
  const auto settling = Settle(OutcomeKind::kStored);
  EXPECT_EQ(ticket->state, Ticket::State::kCommitted);
  EXPECT_EQ(settling.counts.stored, 1U);
  EXPECT_EQ(settling.counts.in_flight, -1);
  EXPECT_TRUE(waiting_.empty());
  EXPECT_EQ(calls_.waiting().records, 0U);
  EXPECT_EQ(calls_.waiting().bytes, 0U);
}

TEST_F(WaitingSamplesTest, WhatTheStoreHadIsADuplicate) {
  const TicketRef ticket = Add(1, 2);
  static_cast<void>(Settle(OutcomeKind::kDuplicate));
  EXPECT_EQ(Settle(OutcomeKind::kDuplicate).counts.duplicate, 1U);
  EXPECT_TRUE(ticket->was_stored);
}

TEST_F(WaitingSamplesTest, ASampleOfWhichOneRecordIsKeptIsStored) {
  const TicketRef ticket = Add(1, 2);
  static_cast<void>(Settle(OutcomeKind::kRefused));
  EXPECT_EQ(Settle(OutcomeKind::kStored).counts.stored, 1U);
  EXPECT_FALSE(ticket->refused);
}

TEST_F(WaitingSamplesTest, ASampleOfWhichTheStoreKeepsNothingIsRejectedWithItsReason) {
  const TicketRef ticket = Add(1);
  const auto settling = Settle(OutcomeKind::kRefused);
  EXPECT_EQ(settling.counts.rejected, 1U);
  ASSERT_TRUE(ticket->refused);
  EXPECT_EQ(ticket->refused->reason, model::RejectReason::kTooManyItems);
}

TEST_F(WaitingSamplesTest, ARowOfQuarantineThatIsStoredCountsAsRejected) {
  static_cast<void>(Add(1, 1, true, model::RejectReason::kOutOfRange));
  const auto settling = Settle(OutcomeKind::kStored);
  EXPECT_EQ(settling.counts.rejected, 1U);
  EXPECT_EQ(settling.counts.stored, 0U);
}

TEST_F(WaitingSamplesTest, VoidingTellsAllAndWhatSettlesLaterChangesNothing) {
  const TicketRef first = Add(1, 2);
  const TicketRef second = Add(2);
  first->callers.push_back({});
  second->callers.push_back({});
  const auto settling = waiting_.VoidAll();
  EXPECT_EQ(settling.counts.refused, 2U);
  EXPECT_EQ(settling.counts.in_flight, -2);
  EXPECT_EQ(calls_.waiting().records, 0U);
  EXPECT_EQ(settling.wake.size(), 2U);
  EXPECT_EQ(first->state, Ticket::State::kVoid);
  EXPECT_EQ(second->state, Ticket::State::kVoid);
  const TicketRef anew = Add(1);
  EXPECT_EQ(Settle(OutcomeKind::kFenced).counts.stored, 0U);
  EXPECT_EQ(Settle(OutcomeKind::kFenced).counts.stored, 0U);
  EXPECT_EQ(Settle(OutcomeKind::kFenced).counts.stored, 0U);
  EXPECT_EQ(anew->state, Ticket::State::kWaiting);
  EXPECT_EQ(Settle(OutcomeKind::kStored).counts.stored, 1U);
  EXPECT_EQ(anew->state, Ticket::State::kCommitted);
}

TEST_F(WaitingSamplesTest, AQuestionIsInNoCountAndIsNoSample) {
  const TicketRef ticket = Ask();
  AddQuestion();
  EXPECT_EQ(waiting_.Find(0, nullptr), nullptr);
  const auto settling = Settle(OutcomeKind::kDuplicate);
  EXPECT_EQ(ticket->state, Ticket::State::kCommitted);
  EXPECT_EQ(settling.counts.duplicate, 0U);
  EXPECT_EQ(settling.counts.in_flight, 0);
  EXPECT_EQ(calls_.waiting().records, 0U);
}

TEST_F(WaitingSamplesTest, HoweverManyAskOneQuestionIsOnItsWay) {
  const TicketRef first = Ask();
  AddQuestion();
  const TicketRef next = Ask();
  EXPECT_NE(next, first) << "the first may have been looked at before this came";
  EXPECT_EQ(Ask(), next);
  EXPECT_FALSE(waiting_.HasDueQuestion());
  EXPECT_EQ(Settle(OutcomeKind::kDuplicate).wake.size(), 1U);
  EXPECT_EQ(next->state, Ticket::State::kWaiting);
  AddQuestion();
  EXPECT_EQ(Settle(OutcomeKind::kDuplicate).wake.size(), 2U);
  EXPECT_EQ(next->state, Ticket::State::kCommitted);
  EXPECT_FALSE(waiting_.HasDueQuestion());
}

TEST_F(WaitingSamplesTest, AQuestionOfWhichAllCallersLeftDoesNotGo) {
  Ask()->callers.clear();
  EXPECT_FALSE(waiting_.HasDueQuestion());
}

TEST_F(WaitingSamplesTest, AVoidQuestionIsTheNextOnesTooAndAnotherMayBeAsked) {
  const TicketRef first = Ask();
  AddQuestion();
  const TicketRef next = Ask();
  EXPECT_EQ(waiting_.VoidAll().wake.size(), 2U);
  EXPECT_EQ(first->state, Ticket::State::kVoid);
  EXPECT_EQ(next->state, Ticket::State::kVoid);
  EXPECT_FALSE(waiting_.HasDueQuestion());
  const TicketRef anew = Ask();
  EXPECT_EQ(anew->state, Ticket::State::kWaiting);
  EXPECT_TRUE(waiting_.HasDueQuestion());
}

TEST_F(WaitingSamplesTest, InDoubtThoseWhoAskOfferAgainAndWhatWaitsStays) {
  const TicketRef sample = Add(1);
  sample->callers.push_back({});
  const TicketRef asked = Ask();
  AddQuestion();
  const TicketRef next = Ask();
  EXPECT_EQ(waiting_.VoidQuestions().size(), 2U);
  EXPECT_EQ(asked->state, Ticket::State::kVoid);
  EXPECT_EQ(next->state, Ticket::State::kVoid);
  EXPECT_EQ(Settle(OutcomeKind::kStored).counts.stored, 1U);
  EXPECT_EQ(sample->state, Ticket::State::kCommitted);
  EXPECT_TRUE(Settle(OutcomeKind::kDuplicate).wake.empty());
  EXPECT_EQ(asked->state, Ticket::State::kVoid) << "it was told to offer again";
  EXPECT_TRUE(waiting_.empty());
}

TEST_F(WaitingSamplesTest, ASampleWithATimeIsFoundAmongAllThatWait) {
  const TicketRef first = Add(1);
  const TicketRef second = Add(2);
  EXPECT_EQ(Find(1), first);
  EXPECT_EQ(Find(2), second);
  EXPECT_EQ(Find(3), nullptr);
  EXPECT_EQ(waiting_.Find(kType, nullptr), second) << "the last of the type";
  EXPECT_EQ(waiting_.Find(kType + 1, nullptr), nullptr);
}

TEST_F(WaitingSamplesTest, ASampleWithoutATimeIsFoundOnlyAsTheLast) {
  const TicketRef first = Add(1, 1, false);
  EXPECT_EQ(Find(1), first);
  static_cast<void>(Add(2, 1, false));
  EXPECT_EQ(Find(1), nullptr);
}

}  // namespace
}  // namespace uplink::uncrew
