#include "server/journal/inbox.h"

#include <deque>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class InboxTest : public ::testing::Test, protected StepBench {
 protected:
  InboxTest() : StepBench({.bytes_max = 4000, .records_max = 3}) {
    holds.Begin(robot_, robot_.robot(), {.since = 1});
  }

  [[nodiscard]] GatheredBatch Fill(std::size_t records_max, std::size_t bytes_max = 1'000'000) {
    return writer_inbox.Fill(GatheredBatch(model::SessionId()),
                             {.records_max = records_max, .bytes_max = bytes_max, .robot = share_},
                             holds.robots());
  }
  /// All that waits is taken, and done.
  void Drain() {
    const GatheredBatch batch = Fill(100);
    writer_inbox.Release({.records = batch.entries(), .bytes = batch.bytes(), .batch_ended = true});
    writer_inbox.CountPresenceCommitted(batch.batch().presence.size());
  }
  void NotePresence(const RecordingClient& client, model::Presence presence) {
    inbox.NotePresence(client.robot(), presence, clock.System());
  }

  CountingInbox wakes_;
  BatchShare share_;
  RecordingClient robot_{"rcan://a"};
  RecordingClient other_{"rcan://b"};
};

TEST_F(InboxTest, IsIdleUntilSomethingComesAndOnceItIsDone) {
  EXPECT_TRUE(inbox.idle());
  Append(robot_, 1);
  EXPECT_FALSE(inbox.idle());
  Drain();
  EXPECT_TRUE(inbox.idle());
  NotePresence(robot_, model::Presence::kOnline);
  EXPECT_FALSE(inbox.idle());
  Drain();
  EXPECT_TRUE(inbox.idle());
  Open(robot_);
  EXPECT_FALSE(inbox.idle());
  EXPECT_THAT(writer_inbox.TakeOpens({}, 9).opens, SizeIs(1));
  EXPECT_FALSE(inbox.idle()) << "it was taken, and is not open";
  writer_inbox.CountOpened(1);
  EXPECT_TRUE(inbox.idle());
}

TEST_F(InboxTest, WhatWasTakenStillCounts) {
  Append(robot_, 1, std::string(100, 'x'));
  const std::size_t bytes = inbox.bytes();
  EXPECT_GT(bytes, 200U);
  const GatheredBatch batch = Fill(9);
  EXPECT_EQ(inbox.records(), 1U);
  EXPECT_EQ(inbox.bytes(), bytes);
  EXPECT_EQ(batch.bytes(), bytes);
  writer_inbox.Release({.records = 1, .bytes = bytes, .batch_ended = true});
  EXPECT_EQ(inbox.records(), 0U);
  EXPECT_EQ(inbox.bytes(), 0U);
}

TEST_F(InboxTest, HasRoomBelowItsRecordsAndItsBytes) {
  Append(robot_, 1);
  AppendGap(robot_, 2);
  EXPECT_TRUE(inbox.HasRoom());
  Append(robot_, 4);
  EXPECT_FALSE(inbox.HasRoom()) << "as many records as it may hold";
  Drain();
  EXPECT_TRUE(inbox.HasRoom());
  Append(robot_, 5, std::string(3486, 'x'));
  EXPECT_TRUE(inbox.HasRoom()) << "two bytes are left";
  Append(robot_, 6);
  EXPECT_FALSE(inbox.HasRoom());
}

TEST_F(InboxTest, WakesOncePerRequestWhenThereIsRoom) {
  const loop::StreamRef stream{.inbox = &wakes_, .stream = 9};
  inbox.WhenRoom(stream);
  EXPECT_EQ(wakes_.wakes(9), 1) << "there is room now";
  for (model::Seq seq = 1; seq <= 4; ++seq) Append(robot_, seq);
  inbox.WhenRoom(stream);
  inbox.WhenRoom(stream);
  writer_inbox.Release({.records = 1, .bytes = 0, .batch_ended = false});
  EXPECT_EQ(wakes_.wakes(9), 1) << "it is still full";
  writer_inbox.Release({.records = 1, .bytes = 0, .batch_ended = false});
  EXPECT_EQ(wakes_.wakes(9), 2);
  writer_inbox.Release({.records = 1, .bytes = 0, .batch_ended = false});
  EXPECT_EQ(wakes_.wakes(9), 2);
}

TEST_F(InboxTest, ABatchEndsAtItsRecordsGapsIncluded) {
  Append(robot_, 1);
  AppendGap(robot_, 2);
  Append(robot_, 3);
  EXPECT_THAT(SeqsOf(Fill(2).batch()), ElementsAre(1, 2));
  EXPECT_THAT(SeqsOf(Fill(2).batch()), ElementsAre(3));
  EXPECT_TRUE(Fill(2).empty());
}

TEST_F(InboxTest, ABatchEndsWithTheRecordThatReachesItsBytes) {
  for (model::Seq seq = 1; seq <= 3; ++seq) Append(robot_, seq);
  const std::size_t each = inbox.bytes() / 3;
  EXPECT_THAT(SeqsOf(Fill(9, each + 1).batch()), ElementsAre(1, 2));
  EXPECT_THAT(SeqsOf(Fill(9, 1).batch()), ElementsAre(3));
}

TEST_F(InboxTest, ARobotThatHasItsShareOfABatchIsPassedOverAndKeepsItsOrder) {
  holds.Begin(other_, other_.robot(), {.since = 1});
  for (model::Seq seq = 1; seq <= 3; ++seq) Append(robot_, seq);
  AppendGap(robot_, 4);
  Append(other_, 10);
  Append(robot_, 5);
  Append(other_, 11);
  share_.records_max = 2;
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(1, 10, 2, 11));
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(3, 4)) << "a gap is one of its entries";
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(5));
}

TEST_F(InboxTest, ARecordOverTheShareOfABatchGoesAlone) {
  holds.Begin(other_, other_.robot(), {.since = 1});
  for (model::Seq seq = 1; seq <= 3; ++seq) Append(robot_, seq);
  Append(other_, 10);
  share_.bytes_max = 1;
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(1, 10));
  share_.bytes_max = 2 * (inbox.bytes() / 4);
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(2, 3)) << "at the share, not past it";
}

TEST_F(InboxTest, ManyThatLagLeaveHalfOfABatchToOthersAndTakeTurns) {
  RecordingClient third("rcan://c");
  holds.Begin(other_, other_.robot(), {.since = 1});
  holds.Begin(third, third.robot(), {.since = 1});
  share_.records_max = 1;
  for (model::Seq seq = 1; seq <= 4; ++seq) {
    Append(robot_, seq);
    Append(other_, 10 + seq);
  }
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(1, 11));
  Append(third, 21);
  EXPECT_THAT(SeqsOf(Fill(2).batch()), ElementsAre(2, 21));
  EXPECT_THAT(SeqsOf(Fill(2).batch()), ElementsAre(12, 3)) << "the half that is left is theirs";
  std::vector<model::Seq> alternately;
  for (model::Seq i = 0; i < 4; ++i) {
    Append(third, 30 + i);
    for (const model::Seq seq : SeqsOf(Fill(1).batch())) alternately.push_back(seq);
  }
  EXPECT_THAT(alternately, ::testing::UnorderedElementsAre(13, 30, 4, 31));
}

TEST_F(InboxTest, WhatIsPutBackGoesAheadOfWhatLags) {
  holds.Begin(other_, other_.robot(), {.since = 1});
  for (model::Seq seq = 1; seq <= 5; ++seq) Append(robot_, seq);
  Append(other_, 10);
  share_.records_max = 2;
  GatheredBatch taken = Fill(9);
  EXPECT_THAT(SeqsOf(taken.batch()), ElementsAre(1, 10, 2));
  EXPECT_EQ(inbox.oldest(clock.Steady()), milliseconds(0));
  writer_inbox.PutBack(taken.TakeRest(1));
  Append(robot_, 6);
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(2, 3, 10));
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(4, 5));
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(6));
}

TEST_F(InboxTest, ABatchPassesOverSoManyRobotsAndNoMore) {
  std::deque<RecordingClient> unopened;
  for (std::size_t i = 0; i <= kPassedMax; ++i) {
    Append(unopened.emplace_back("rcan://unopened/" + std::to_string(i)), 1);
  }
  Append(robot_, 1);
  EXPECT_TRUE(Fill(9).empty()) << "the robot lies behind too many";
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(1));
}

TEST_F(InboxTest, ABatchPassesOverARobotThatIsNotHeld) {
  Append(robot_, 1);
  Append(other_, 2);
  Append(robot_, 3);
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(1, 3));
  holds.Begin(other_, other_.robot(), {.since = 1});
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(2));
}

TEST_F(InboxTest, WhatIsPutBackGoesFirst) {
  for (model::Seq seq = 1; seq <= 3; ++seq) Append(robot_, seq);
  AppendGap(robot_, 10);
  AppendGap(robot_, 11);
  GatheredBatch batch = Fill(9);
  Append(robot_, 12);
  writer_inbox.PutBack(batch.TakeRest(1));
  EXPECT_THAT(SeqsOf(batch.batch()), ElementsAre(1, 10));
  EXPECT_THAT(SeqsOf(Fill(9).batch()), ElementsAre(2, 3, 12, 11));
}

TEST_F(InboxTest, ChangesOfPresenceThatWerePutBackGoAheadOfNewOnes) {
  holds.Begin(other_, other_.robot(), {.since = 1});
  NotePresence(robot_, model::Presence::kOnline);
  NotePresence(other_, model::Presence::kOnline);
  GatheredBatch batch = Fill(9);
  NotePresence(robot_, model::Presence::kOffline);
  writer_inbox.PutBack(batch.TakeRest(1));
  const GatheredBatch next = Fill(9);
  ASSERT_THAT(next.batch().presence, SizeIs(1));
  EXPECT_EQ(next.batch().presence[0].robot, other_.robot());
  EXPECT_EQ(next.batch().presence[0].number, 2U);
  ASSERT_THAT(Fill(9).batch().presence, SizeIs(1));
}

TEST_F(InboxTest, TheOldestIsOfTheBatchThatWasTakenElseOfTheQueue) {
  EXPECT_EQ(inbox.oldest(clock.Steady()), milliseconds(0));
  Append(robot_, 1);
  clock.Advance(milliseconds(5));
  Append(robot_, 2);
  EXPECT_EQ(inbox.oldest(clock.Steady()), milliseconds(5));
  EXPECT_THAT(SeqsOf(Fill(1).batch()), ElementsAre(1));
  EXPECT_EQ(inbox.oldest(clock.Steady()), milliseconds(5)) << "it is not done";
  writer_inbox.Release({.records = 1, .bytes = 0, .batch_ended = true});
  clock.Advance(milliseconds(2));
  EXPECT_EQ(inbox.oldest(clock.Steady()), milliseconds(2));
}

TEST_F(InboxTest, SaysWhetherRecordsWaitBesideTheStreams) {
  Open(robot_);
  EXPECT_FALSE(writer_inbox.TakeOpens({}, 9).records_wait);
  Append(robot_, 1);
  EXPECT_TRUE(writer_inbox.TakeOpens({}, 9).records_wait);
  Drain();
  NotePresence(robot_, model::Presence::kOnline);
  EXPECT_TRUE(writer_inbox.TakeOpens({}, 9).records_wait);
}

TEST_F(InboxTest, StreamsThatArePutBackWaitAgain) {
  Open(robot_);
  WriterInbox::TakenOpens taken = writer_inbox.TakeOpens({}, 9);
  EXPECT_THAT(writer_inbox.TakeOpens({}, 9).opens, IsEmpty());
  writer_inbox.PutBackOpens(std::move(taken.opens));
  EXPECT_THAT(writer_inbox.TakeOpens({}, 9).opens, SizeIs(1));
}

TEST_F(InboxTest, ACheckpointThatWasAskedForIsOpenUntilItsRoundHasEnded) {
  EXPECT_FALSE(writer_inbox.BeginCheckpoint()) << "one that is due answers no request";
  inbox.RequestCheckpoint();
  EXPECT_TRUE(writer_inbox.checkpoint_asked());
  EXPECT_TRUE(writer_inbox.BeginCheckpoint());
  EXPECT_FALSE(writer_inbox.checkpoint_asked());
  EXPECT_FALSE(inbox.idle());
  writer_inbox.EndCheckpoint();
  EXPECT_TRUE(inbox.idle());
}

TEST_F(InboxTest, ACheckpointThatWasAskedForDuringARoundIsOpenAfterIt) {
  EXPECT_FALSE(writer_inbox.BeginCheckpoint());
  inbox.RequestCheckpoint();
  writer_inbox.EndCheckpoint();
  EXPECT_TRUE(writer_inbox.checkpoint_asked());
  EXPECT_FALSE(inbox.idle());
}

TEST_F(InboxTest, ACheckpointThatIsRenewedStaysOpen) {
  inbox.RequestCheckpoint();
  EXPECT_TRUE(writer_inbox.BeginCheckpoint());
  writer_inbox.RenewCheckpoint();
  writer_inbox.EndCheckpoint();
  EXPECT_TRUE(writer_inbox.checkpoint_asked());
  EXPECT_FALSE(inbox.idle());
}

/// Waits in a thread of its own, for hours; join it to see that the wait has ended.
class InboxWait : public InboxTest {
 protected:
  [[nodiscard]] std::jthread Wait() {
    return std::jthread([this](const std::stop_token& stop) {
      writer_inbox.WaitUntil(clock.Steady() + std::chrono::hours(9), stop);
    });
  }
};

TEST_F(InboxWait, EndsWhenARecordComes) {
  std::jthread waits = Wait();
  Append(robot_, 1);
  waits.join();
}

TEST_F(InboxWait, EndsWhenAStreamIsAskedFor) {
  std::jthread waits = Wait();
  Open(robot_);
  waits.join();
}

TEST_F(InboxWait, EndsWhenAPresenceChanges) {
  std::jthread waits = Wait();
  NotePresence(robot_, model::Presence::kOnline);
  waits.join();
}

TEST_F(InboxWait, EndsWhenARobotIsToBeAdopted) {
  std::jthread waits = Wait();
  inbox.Adopt({.client = &robot_, .request = {.robot = robot_.robot()}});
  waits.join();
}

TEST_F(InboxWait, EndsWhenARobotWasLost) {
  std::jthread waits = Wait();
  inbox.Lose({.client = &robot_, .robot = robot_.robot(), .since = 2});
  waits.join();
}

TEST_F(InboxWait, EndsWhenACheckpointIsAskedFor) {
  std::jthread waits = Wait();
  inbox.RequestCheckpoint();
  waits.join();
}

TEST_F(InboxWait, EndsWhenItIsStopped) {
  std::jthread waits = Wait();
  waits.request_stop();
  waits.join();
}

TEST_F(InboxWait, EndsAtOnceWhatIsDueAlready) {
  writer_inbox.WaitUntil(clock.Steady() - milliseconds(1), {});
  EXPECT_TRUE(inbox.idle());
}

}  // namespace
}  // namespace uplink::journal
