// What sessions keep in memory, apart from any stream's frames.
#include "server/robot/robot_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SilentInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

model::SessionId Id(std::uint8_t number) { return model::SessionId({number}); }

const model::Rejection kBad{model::RejectReason::kMissingField, "faultId", "empty"};

class RobotSessionsTest : public ::testing::Test {
 protected:
  RobotSessionsTest() {
    static_cast<void>(sessions_.Attach(Stream(1), clock_.Steady(), clock_.System()));
    begun_ = *sessions_.Begin(Id(1), clock_.Steady());
  }
  loop::StreamRef Stream(std::uint64_t number) { return {.inbox = &inbox_, .stream = number}; }
  std::vector<model::Seq> Rejects(const Resume& resume) {
    std::vector<model::Seq> seqs;
    for (const RejectedSeq& rejected : resume.rejects) seqs.push_back(rejected.seq);
    return seqs;
  }
  loop::StreamRef Settle(model::Seq seq, storage::Outcome outcome,
                         std::optional<model::RejectReason> rejected_for = std::nullopt) {
    const Settled settled{.session = Id(1),
                          .seq = seq,
                          .outcome = std::move(outcome),
                          .rejected_for = rejected_for,
                          .arrived = clock_.Steady()};
    return sessions_.OnSettled({&settled, 1}, ledger_);
  }

  testing::ManualClock clock_;
  SilentInbox inbox_;
  metrics::Ledger ledger_;
  RobotSessions sessions_;
  RobotSessions::Begun begun_;
};

TEST_F(RobotSessionsTest, OpenedOnlyByTheAnswerThatWasAskedFor) {
  sessions_.OnOpened(begun_.open_id + 1, {.cursor = 9});
  EXPECT_FALSE(sessions_.Opened(begun_.open_id));
  EXPECT_EQ(sessions_.OnOpened(begun_.open_id, {.cursor = 9}), Stream(1));
  EXPECT_TRUE(sessions_.Opened(begun_.open_id));
  const auto again = sessions_.Begin(Id(1), clock_.Steady());
  EXPECT_FALSE(sessions_.Opened(begun_.open_id));
  EXPECT_FALSE(sessions_.Opened(again->open_id));
}

TEST_F(RobotSessionsTest, WhereTheAnswerLeavesRejectsOutTheCursorCountsAndAcksWait) {
  sessions_.OnOpened(begun_.open_id,
                     {.cursor = 9, .rejects = {{4, kBad}, {5, kBad}}, .rejects_total = 4});
  const Resume resume = sessions_.ResumeFrom(Id(1), begun_.open_id, 3, 3);
  EXPECT_EQ(resume.committed, 9U);
  EXPECT_THAT(Rejects(resume), ElementsAre(4, 5));
  EXPECT_EQ(sessions_.unconfirmed(), 4U) << "those that are unread count";
  EXPECT_EQ(sessions_.Take(Id(1)).through, 5U);
  EXPECT_TRUE(sessions_.AwaitsRejects(Id(1)));
  ASSERT_TRUE(sessions_.UnreadOf(Id(1)).has_value());
  EXPECT_EQ(sessions_.UnreadOf(Id(1))->after, 5U);
  EXPECT_EQ(sessions_.UnreadOf(Id(1))->through, 9U);
  sessions_.AddPage(Id(1), {{7, kBad}}, 7);
  const Progress part = sessions_.Take(Id(1));
  EXPECT_EQ(part.through, 7U);
  ASSERT_THAT(part.rejects, SizeIs(1));
  EXPECT_EQ(part.rejects.front().seq, 7U);
  sessions_.AddPage(Id(1), {{8, kBad}}, 9);
  EXPECT_EQ(sessions_.Take(Id(1)).through, 9U);
  EXPECT_FALSE(sessions_.AwaitsRejects(Id(1)));
  EXPECT_FALSE(sessions_.UnreadOf(Id(1)).has_value());
  EXPECT_EQ(sessions_.unconfirmed(), 4U);
}

TEST_F(RobotSessionsTest, ACommitThatTheAgentWasNotToldIsAckedOnceTheStoreHasAnswered) {
  sessions_.OnOpened(begun_.open_id, {});
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0));
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 2), 1);
  Settle(1, {});
  Settle(2, {});
  // The agent learned of 1 alone, and connects again while the store is away.
  const auto again = sessions_.Begin(Id(1), clock_.Steady());
  EXPECT_EQ(sessions_.ResumeFrom(Id(1), again->open_id, 1, 1).committed, 1U);
  EXPECT_EQ(sessions_.See(Id(1), 2).as, SeenAs::kDuplicate);
  EXPECT_EQ(sessions_.Take(Id(1)).through, 1U) << "a store that comes back may lack it";
  EXPECT_TRUE(sessions_.AwaitsRejects(Id(1)));
  EXPECT_EQ(sessions_.OnOpened(again->open_id, {.cursor = 2}), Stream(1));
  EXPECT_EQ(sessions_.Take(Id(1)).through, 2U);
  EXPECT_FALSE(sessions_.AwaitsRejects(Id(1)));
}

TEST_F(RobotSessionsTest, WhatTheAgentWasToldNeedsNoStore) {
  sessions_.OnOpened(begun_.open_id, {});
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0));
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  Settle(1, {});
  sessions_.AddSettled(Id(1), 2);
  const auto again = sessions_.Begin(Id(1), clock_.Steady());
  EXPECT_EQ(sessions_.ResumeFrom(Id(1), again->open_id, 1, 1).committed, 2U);
  EXPECT_EQ(sessions_.Take(Id(1)).through, 2U) << "2 was live, and leaves no row";
}

TEST_F(RobotSessionsTest, SaysWhatTheStoreToldOfEachSession) {
  EXPECT_THAT(sessions_.Committed(), IsEmpty());
  sessions_.OnOpened(begun_.open_id, {.cursor = 4});
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0));
  EXPECT_THAT(sessions_.Committed(), ElementsAre(storage::CommittedSession{Id(1), 4}));
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 5), 1);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 6), 1);
  sessions_.AddSettled(Id(1), 7);
  Settle(6, {storage::OutcomeKind::kRefused, kBad});
  EXPECT_THAT(sessions_.Committed(), ElementsAre(storage::CommittedSession{Id(1), 6}));
}

TEST_F(RobotSessionsTest, AStoreThatWentBackEndsTheStreamAndVoidsWhatWaits) {
  sessions_.OnOpened(begun_.open_id, {.cursor = 4});
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0));
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 5), 1);
  EXPECT_EQ(sessions_.OnWentBack(ledger_), Stream(1));
  EXPECT_EQ(sessions_.StandingOf(Stream(1)), Standing::kWentBack);
  EXPECT_GT(sessions_.generation(), begun_.generation);
  EXPECT_EQ(sessions_.Take(Id(1)).through, 0U) << "nothing is acked from memory any more";
  EXPECT_EQ(sessions_.See(Id(1), 3).as, SeenAs::kVoid);
  EXPECT_THAT(sessions_.Committed(), IsEmpty());
  EXPECT_EQ(sessions_.in_flight(), 0U);
}

TEST_F(RobotSessionsTest, AFenceDropsWhatIsYetToBeRead) {
  sessions_.OnOpened(begun_.open_id, {.cursor = 9, .rejects = {{4, kBad}}, .rejects_total = 2});
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 3, 3));
  sessions_.OnFenced(ledger_);
  EXPECT_FALSE(sessions_.UnreadOf(Id(1)).has_value());
  sessions_.AddPage(Id(1), {{7, kBad}}, 9);
  EXPECT_THAT(sessions_.Take(Id(1)).rejects, IsEmpty());
}

TEST_F(RobotSessionsTest, UnconfirmedRejectsAreThoseOfTheStreamsSession) {
  sessions_.OnOpened(begun_.open_id, {.cursor = 9, .rejects = {{4, kBad}, {5, kBad}}});
  EXPECT_EQ(sessions_.unconfirmed(), 0U);
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 3, 3));
  EXPECT_EQ(sessions_.unconfirmed(), 2U);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 10), 1);
  sessions_.Remember(Id(1), {.seq = 10, .rejection = kBad});
  EXPECT_EQ(sessions_.unconfirmed(), 3U);
  Settle(10, {}, model::RejectReason::kMalformed);
  EXPECT_EQ(sessions_.unconfirmed(), 3U);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 11), 1);
  Settle(11, {storage::OutcomeKind::kRefused, kBad});
  EXPECT_EQ(sessions_.unconfirmed(), 4U);
  const auto other = sessions_.Begin(Id(2), clock_.Steady());
  static_cast<void>(sessions_.ResumeFrom(Id(2), other->open_id, 0, 0));
  EXPECT_EQ(sessions_.unconfirmed(), 0U);
}

TEST_F(RobotSessionsTest, MemoryAndQuarantineAreJoinedInOrderWithoutDoubles) {
  for (const model::Seq seq : {2U, 6U, 8U}) {
    sessions_.AddSettled(Id(1), seq);
    sessions_.Remember(Id(1), {.seq = seq, .rejection = kBad});
  }
  sessions_.OnOpened(begun_.open_id, {.cursor = 6, .rejects = {{4, kBad}, {6, kBad}}});
  EXPECT_THAT(Rejects(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0)), ElementsAre(2, 4, 6, 8));
  EXPECT_THAT(Rejects(sessions_.ResumeFrom(Id(1), begun_.open_id, 4, 4)), ElementsAre(6, 8));
}

TEST_F(RobotSessionsTest, WhatIsSkippedIsCountedAboveTheFloorAlone) {
  static_cast<void>(sessions_.ResumeFrom(Id(1), begun_.open_id, 2, 6));
  EXPECT_EQ(sessions_.See(Id(1), 5).missing_first, 0U);
  const Seen seen = sessions_.See(Id(1), 9);
  EXPECT_EQ(seen.as, SeenAs::kNew);
  EXPECT_EQ(seen.missing_first, 7U);
  EXPECT_EQ(seen.missing_last, 8U);
  EXPECT_EQ(sessions_.See(Id(1), 2).as, SeenAs::kDuplicate);
}

TEST_F(RobotSessionsTest, CommitsWakeTheStreamAndCountOnce) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  EXPECT_EQ(sessions_.in_flight(), 1U);
  EXPECT_EQ(sessions_.waiting(Id(1)), 1U);
  EXPECT_EQ(Settle(1, {}), Stream(1));
  Settle(1, {});
  EXPECT_EQ(ledger_.Read().messages.stored, 1U);
  EXPECT_EQ(ledger_.Read().messages.in_flight, -1);
  EXPECT_EQ(sessions_.in_flight(), 0U);
  const Progress progress = sessions_.Take(Id(1));
  EXPECT_EQ(progress.through, 1U);
  EXPECT_THAT(progress.released, SizeIs(1));
  EXPECT_THAT(sessions_.Take(Id(1)).released, IsEmpty());
}

TEST_F(RobotSessionsTest, ARejectionMadeAtJudgementIsNotToldTwice) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  sessions_.Remember(Id(1), {.seq = 1, .rejection = kBad});
  Settle(1, {storage::OutcomeKind::kRefused, kBad}, kBad.reason);
  EXPECT_THAT(sessions_.Take(Id(1)).rejects, IsEmpty());
  EXPECT_EQ(ledger_.Read().messages.rejected, 1U);
}

TEST_F(RobotSessionsTest, ARefusalOfTheStoreIsToldOnceAndRemembered) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  Settle(1, {storage::OutcomeKind::kRefused, kBad});
  EXPECT_THAT(sessions_.Take(Id(1)).rejects, SizeIs(1));
  EXPECT_THAT(sessions_.Take(Id(1)).rejects, IsEmpty());
  EXPECT_THAT(Rejects(sessions_.ResumeFrom(Id(1), begun_.open_id, 0, 0)), ElementsAre(1));
}

TEST_F(RobotSessionsTest, ANumberTheStoreKnewIsADuplicate) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  Settle(1, {storage::OutcomeKind::kDuplicate, std::nullopt});
  EXPECT_EQ(ledger_.Read().messages.duplicate, 1U);
}

TEST_F(RobotSessionsTest, AFenceForgetsEverythingThatWaits) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 2), 1);
  EXPECT_EQ(sessions_.OnFenced(ledger_), Stream(1));
  EXPECT_GT(sessions_.generation(), begun_.generation);
  EXPECT_EQ(sessions_.StandingOf(Stream(1)), Standing::kSuperseded);
  EXPECT_EQ(ledger_.Read().messages.superseded, 2U);
  EXPECT_EQ(ledger_.Read().messages.in_flight, -2);
  EXPECT_EQ(sessions_.See(Id(1), 3).as, SeenAs::kVoid);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 3), 0);
  EXPECT_EQ(sessions_.in_flight(), 0U);
}

TEST_F(RobotSessionsTest, ASessionThatWaitsIsNotForgotten) {
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 1), 1);
  sessions_.Detach(Stream(1), clock_.Steady());
  clock_.Advance(std::chrono::hours(5));
  sessions_.Sweep(clock_.Steady(), std::chrono::hours(1));
  EXPECT_THAT(sessions_.Held(), SizeIs(1));
  Settle(1, {});
  sessions_.Sweep(clock_.Steady(), std::chrono::hours(1));
  EXPECT_THAT(sessions_.Held(), IsEmpty());
}

TEST_F(RobotSessionsTest, TheStreamsOwnSessionIsNotForgotten) {
  clock_.Advance(std::chrono::hours(5));
  sessions_.Sweep(clock_.Steady(), std::chrono::hours(1));
  EXPECT_THAT(sessions_.Held(), SizeIs(1));
}

TEST_F(RobotSessionsTest, WhatTheStoreHasIsShownUntilAStreamBeginsAndNumbersNothing) {
  RobotSessions fresh;
  fresh.Restore({Id(7), 40});
  EXPECT_EQ(fresh.View().session, Id(7));
  EXPECT_EQ(fresh.View().settled_seq, 40U);
  EXPECT_EQ(fresh.View().missing, 0U);
  EXPECT_FALSE(fresh.View().connected);
  EXPECT_THAT(fresh.Held(), IsEmpty());
  EXPECT_EQ(fresh.See(Id(7), 41).as, SeenAs::kVoid) << "no session began";
  fresh.Sweep(clock_.Steady(), milliseconds(0));
  EXPECT_EQ(fresh.View().session, Id(7)) << "nothing that a sweep forgets";
  const auto begun = fresh.Begin(Id(7), clock_.Steady());
  EXPECT_EQ(fresh.View().settled_seq, 0U) << "from here on, what is held";
  EXPECT_EQ(fresh.ResumeFrom(Id(7), begun->open_id, 3, 3).committed, 3U);
}

TEST_F(RobotSessionsTest, OfTwoAnswersOfTheStoreTheFurtherIsShown) {
  RobotSessions fresh;
  fresh.Restore({Id(7), 40});
  fresh.Restore({Id(7), 39});
  EXPECT_EQ(fresh.View().settled_seq, 40U);
  fresh.Restore({Id(8), 2});
  EXPECT_EQ(fresh.View().session, Id(8));
  EXPECT_EQ(fresh.View().settled_seq, 2U) << "another session";
}

TEST_F(RobotSessionsTest, WhatIsHeldIsShownRatherThanWhatTheStoreHas) {
  sessions_.AddSettled(Id(1), 5);
  sessions_.Restore({Id(7), 40});
  EXPECT_EQ(sessions_.View().session, Id(1));
  EXPECT_EQ(sessions_.View().settled_seq, 5U);
}

TEST_F(RobotSessionsTest, ASessionThatWasForgottenForItsAgeIsStillShown) {
  sessions_.AddSettled(Id(1), 5);
  sessions_.Detach(Stream(1), clock_.Steady());
  clock_.Advance(std::chrono::hours(5));
  sessions_.Sweep(clock_.Steady(), std::chrono::hours(1));
  ASSERT_THAT(sessions_.Held(), IsEmpty());
  EXPECT_EQ(sessions_.View().session, Id(1));
  EXPECT_EQ(sessions_.View().settled_seq, 5U);
}

TEST_F(RobotSessionsTest, AFenceForgetsWhatWasShown) {
  RobotSessions fresh;
  fresh.Restore({Id(7), 40});
  fresh.OnFenced(ledger_);
  EXPECT_FALSE(fresh.View().session);
  EXPECT_EQ(fresh.View().settled_seq, 0U);
}

TEST_F(RobotSessionsTest, WhatIsSettledIsNewsOnce) {
  EXPECT_FALSE(RobotSessions().TakeSettled()) << "there is none";
  EXPECT_EQ(sessions_.TakeSettled(), (storage::SettledSession{Id(1), 0}));
  EXPECT_FALSE(sessions_.TakeSettled());
  sessions_.AddSettled(Id(1), 5);
  const storage::SettledSession fifth{Id(1), 5};
  EXPECT_EQ(sessions_.TakeSettled(), fifth);
  EXPECT_FALSE(sessions_.TakeSettled());
  sessions_.PutBackSettled();
  EXPECT_EQ(sessions_.TakeSettled(), fifth);
  EXPECT_EQ(sessions_.AddWaiting(Id(1), 6), 1);
  sessions_.AddSettled(Id(1), 7);
  EXPECT_FALSE(sessions_.TakeSettled()) << "6 waits";
  Settle(6, {});
  EXPECT_EQ(sessions_.TakeSettled(), (storage::SettledSession{Id(1), 7}));
  sessions_.OnFenced(ledger_);
  EXPECT_FALSE(sessions_.TakeSettled());
}

TEST_F(RobotSessionsTest, ViewsShowWhatHoldsTheStreamBackAndSinceWhen) {
  EXPECT_EQ(sessions_.View().held_back, HeldBack::kNone);
  const SystemTime since = clock_.System();
  sessions_.SetHeldBack(HeldBack::kInFlight, since);
  clock_.Advance(milliseconds(5));
  sessions_.SetHeldBack(HeldBack::kJournal, clock_.System());
  EXPECT_EQ(sessions_.View().held_back, HeldBack::kJournal);
  EXPECT_EQ(sessions_.View().held_back_since, since) << "it was not read in between";
  sessions_.SetHeldBack(HeldBack::kNone, clock_.System());
  EXPECT_EQ(sessions_.View().held_back, HeldBack::kNone);
  clock_.Advance(kHeldBackAgain);
  sessions_.SetHeldBack(HeldBack::kUnread, clock_.System());
  EXPECT_EQ(sessions_.View().held_back_since, since) << "it was so nearly all the time";
  sessions_.SetHeldBack(HeldBack::kNone, clock_.System());
  clock_.Advance(kHeldBackAgain + milliseconds(1));
  sessions_.SetHeldBack(HeldBack::kUnread, clock_.System());
  EXPECT_EQ(sessions_.View().held_back_since, clock_.System());
}

TEST_F(RobotSessionsTest, DetachReturnsTheStreamThatIsNext) {
  EXPECT_EQ(sessions_.Attach(Stream(2), clock_.Steady(), clock_.System()).standing,
            Standing::kWaiting);
  EXPECT_EQ(sessions_.StandingOf(Stream(1)), Standing::kSuperseded);
  EXPECT_EQ(sessions_.StandingOf(Stream(2)), Standing::kWaiting);
  EXPECT_EQ(sessions_.Detach(Stream(1), clock_.Steady()), Stream(2));
  EXPECT_EQ(sessions_.StandingOf(Stream(2)), Standing::kCurrent);
  EXPECT_FALSE(sessions_.Detach(Stream(1), clock_.Steady())) << "it is gone already";
  EXPECT_EQ(sessions_.StandingOf(Stream(2)), Standing::kCurrent);
}

TEST_F(RobotSessionsTest, NoticesPastTheBoundShareOneSlot) {
  const SteadyTime now = clock_.Steady();
  for (std::size_t i = 0; i < kNoticeFieldsMax; ++i) {
    EXPECT_TRUE(sessions_.MayNotice("field" + std::to_string(i), now));
  }
  EXPECT_TRUE(sessions_.MayNotice("one more", now));
  EXPECT_FALSE(sessions_.MayNotice("and another", now));
  EXPECT_FALSE(sessions_.MayNotice("field0", now));
  EXPECT_TRUE(sessions_.MayNotice("and another", now + std::chrono::seconds(1)));
}

TEST_F(RobotSessionsTest, PayloadsAreKeptOnceASecondAReason) {
  const SteadyTime now = clock_.Steady();
  EXPECT_TRUE(sessions_.KeepPayload(model::RejectReason::kMalformed, now));
  EXPECT_TRUE(sessions_.KeepPayload(model::RejectReason::kStoreRefused, now));
  EXPECT_FALSE(sessions_.KeepPayload(model::RejectReason::kMalformed, now + milliseconds(999)));
  EXPECT_TRUE(sessions_.KeepPayload(model::RejectReason::kMalformed, now + milliseconds(1000)));
}

}  // namespace
}  // namespace uplink::robot
