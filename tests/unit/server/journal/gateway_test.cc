// What robots of one gateway have of a journal together: its certificate's turns, and its share.
#include <deque>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

constexpr model::Seq kHonest = 1'000'000;

class JournalGatewayTest : public ::testing::Test, protected StepBench {
 protected:
  explicit JournalGatewayTest(const JournalLimits& limits = {}) : StepBench(limits) {
    holds.Begin(honest_, honest_.robot(), {.since = 1});
  }

  RecordingClient& NewRobot() {
    RecordingClient& robot = robots_.emplace_back("rcan://g/" + std::to_string(robots_.size()));
    holds.Begin(robot, robot.robot(), {.since = 1});
    return robot;
  }
  void AppendVia(const GatewayRef& gateway, RecordingClient& client, model::Seq seq) {
    inbox.AppendMessage(client, {client.generation(), gateway}, {RecordOf(client, seq)},
                        clock.Steady());
  }
  [[nodiscard]] GatheredBatch Fill(std::size_t records_max,
                                   const BatchShare& share = kGatewayBatchShare) {
    return writer_inbox.Fill(
        GatheredBatch(model::SessionId()),
        {.records_max = records_max, .bytes_max = 1'000'000, .robot = {}, .gateway = share},
        holds.robots());
  }
  [[nodiscard]] std::vector<model::Seq> SeqsOfNext(std::size_t records_max) {
    return SeqsOf(Fill(records_max).batch());
  }
  /// All of it is done.
  void Drop(GatheredBatch batch) {
    const WriterInbox::Done done{
        .records = batch.entries(), .bytes = batch.bytes(), .batch_ended = true};
    batch.ClearEntries();
    writer_inbox.Release(done);
  }

  CountingInbox wakes_;
  RecordingClient honest_{"rcan://honest"};
  std::deque<RecordingClient> robots_;
};

TEST_F(JournalGatewayTest, IsOnePerSubjectAsLongAsAStreamOrAnEntryHasIt) {
  EXPECT_EQ(inbox.GatewayOf(""), nullptr) << "a robot by itself";
  GatewayRef hall = inbox.GatewayOf("CN=hall");
  const GatewayRef yard = inbox.GatewayOf("CN=yard");
  EXPECT_EQ(inbox.GatewayOf("CN=hall"), hall);
  EXPECT_NE(hall, yard);
  AppendVia(hall, NewRobot(), 1);
  AppendVia(hall, NewRobot(), 2);
  hall.reset();
  EXPECT_EQ(inbox.GatewayOf("CN=hall")->records(), 2U) << "its entries wait";
  Drop(Fill(1));
  EXPECT_EQ(inbox.GatewayOf("CN=hall")->records(), 1U);
  Drop(Fill(1));
  EXPECT_EQ(inbox.GatewayOf("CN=hall")->records(), 0U);
  EXPECT_EQ(inbox.GatewayOf("CN=hall")->bytes(), 0U);
}

// The finding: an event of an honest robot waited behind all that 50 streams of one gateway had
// sent.
TEST_F(JournalGatewayTest, AFloodOfItsRobotsKeepsNoOtherRobotWaiting) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  model::Seq seq = 0;
  for (int i = 0; i < 50; ++i) NewRobot();
  for (int event = 0; event < 200; ++event) {
    for (RecordingClient& robot : robots_) AppendVia(gateway, robot, ++seq);
  }
  Append(honest_, kHonest);
  EXPECT_THAT(SeqsOfNext(1000), Contains(kHonest));
  for (model::Seq i = 1; i <= 5; ++i) {
    Append(honest_, kHonest + i);
    EXPECT_THAT(SeqsOfNext(2), Contains(kHonest + i)) << "however small the batch is";
  }
}

TEST_F(JournalGatewayTest, CertificatesGoInTurnAndTheRobotsOfOneToo) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  RecordingClient& first = NewRobot();
  RecordingClient& second = NewRobot();
  for (model::Seq i = 0; i < 3; ++i) {
    AppendVia(gateway, first, 10 + i);
    AppendVia(gateway, second, 20 + i);
    Append(honest_, 30 + i);
  }
  EXPECT_THAT(SeqsOfNext(100), ElementsAre(10, 30, 20, 31, 11, 32, 21, 12, 22));
}

TEST_F(JournalGatewayTest, ARobotOfItKeepsItsOrderWhenItComesByItself) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  RecordingClient& robot = NewRobot();
  AppendVia(gateway, robot, 1);
  AppendVia(gateway, robot, 2);
  Append(robot, 3);
  AppendVia(inbox.GatewayOf("CN=yard"), robot, 4);
  Append(robot, 5);
  EXPECT_EQ(gateway->records(), 2U) << "what it appended by itself is not the gateway's";
  EXPECT_THAT(SeqsOfNext(100), ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(JournalGatewayTest, WhatIsPutBackGoesFirstAndCountsAsBefore) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  RecordingClient& robot = NewRobot();
  for (model::Seq seq = 1; seq <= 4; ++seq) AppendVia(gateway, robot, seq);
  GatheredBatch batch = Fill(100);
  AppendVia(gateway, robot, 5);
  writer_inbox.PutBack(batch.TakeRest(1));
  EXPECT_EQ(gateway->records(), 5U);
  Drop(std::move(batch));
  EXPECT_EQ(gateway->records(), 4U);
  EXPECT_THAT(SeqsOfNext(100), ElementsAre(2, 3, 4, 5));
}

TEST_F(JournalGatewayTest, WhatBecomesVoidCountsNoMore) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  RecordingClient& robot = NewRobot();
  AppendVia(gateway, robot, 1);
  AppendVia(gateway, NewRobot(), 2);
  GatheredBatch batch = Fill(100);
  static_cast<void>(robot.OnFenced(ledger));
  static_cast<void>(batch.DropVoid());
  EXPECT_EQ(gateway->records(), 1U);
}

TEST_F(JournalGatewayTest, HasItsShareOfABatchAndNoMore) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  for (int i = 0; i < 3; ++i) NewRobot();
  for (std::size_t i = 0; i < kGatewayBatchShare.records_max; ++i) {
    AppendVia(gateway, robots_[i % 3], i);
  }
  AppendVia(gateway, robots_[0], 1000);
  AppendVia(inbox.GatewayOf("CN=yard"), NewRobot(), 1001);
  const std::vector<model::Seq> first = SeqsOfNext(1000);
  EXPECT_EQ(first.size(), kGatewayBatchShare.records_max + 1);
  EXPECT_THAT(first, Contains(1001)) << "another gateway's";
  EXPECT_THAT(SeqsOfNext(1000), ElementsAre(1000));
}

TEST_F(JournalGatewayTest, OnceItHasItsShareItsRobotsAreNotLookedAt) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  for (std::size_t i = 1; i <= kPassedMax + 2; ++i) AppendVia(gateway, NewRobot(), i);
  for (model::Seq i = 1; i <= 4; ++i) Append(honest_, kHonest + i);
  EXPECT_THAT(SeqsOf(Fill(9, {.records_max = 2}).batch()),
              ElementsAre(1, kHonest + 1, 2, kHonest + 2, kHonest + 3, kHonest + 4))
      << "a look at each of its robots would end the batch at kPassedMax";
  EXPECT_THAT(SeqsOf(Fill(9, {.records_max = 2}).batch()), ElementsAre(3, 4))
      << "its robots go on in turn";
}

TEST_F(JournalGatewayTest, ARobotThatWasPassedOverGoesBehindThoseThatWereNotLookedAt) {
  const GatewayRef gateway = inbox.GatewayOf("CN=hall");
  RecordingClient& unopened = robots_.emplace_back("rcan://g/unopened");
  AppendVia(gateway, unopened, 1);
  for (model::Seq i = 0; i < 3; ++i) AppendVia(gateway, NewRobot(), 10 + i);
  EXPECT_THAT(SeqsOf(Fill(9, {.records_max = 1}).batch()), ElementsAre(10));
  holds.Begin(unopened, unopened.robot(), {.since = 1});
  EXPECT_THAT(SeqsOfNext(9), ElementsAre(11, 12, 1));
}

TEST_F(JournalGatewayTest, AnotherThatHasItsShareEndsNoTurnOfThisOne) {
  const GatewayRef yard = inbox.GatewayOf("CN=yard");
  const GatewayRef hall = inbox.GatewayOf("CN=hall");
  RecordingClient& of_yard = NewRobot();
  RecordingClient& moved = NewRobot();
  AppendVia(yard, of_yard, 20);
  AppendVia(yard, of_yard, 21);
  AppendVia(hall, moved, 1);
  AppendVia(yard, moved, 2);
  EXPECT_THAT(SeqsOfNext(2), ElementsAre(20, 1));
  AppendVia(hall, NewRobot(), 10);
  EXPECT_THAT(SeqsOf(Fill(9, {.records_max = 1}).batch()), ElementsAre(21, 10));
  EXPECT_THAT(SeqsOf(Fill(9, {.records_max = 1}).batch()), ElementsAre(2));
}

/// A gateway may have 25 of 100 records, one robot 10.
class GatewayShareTest : public JournalGatewayTest {
 protected:
  GatewayShareTest() : JournalGatewayTest({.records_max = 100, .robot_share = 10}) {}

  void FillUpTo(std::size_t records) {
    while (gateway_->records() < records) {
      if (gateway_->records() % 9 == 0) NewRobot();
      AppendVia(gateway_, robots_.back(), gateway_->records() + 1);
    }
  }
  [[nodiscard]] Room RoomOf(std::size_t waiting, const GatewayRef& gateway) {
    return inbox.RoomFor({.records = waiting, .bytes = waiting * 600}, 600, gateway.get());
  }

  const GatewayRef gateway_ = inbox.GatewayOf("CN=hall");
};

TEST_F(GatewayShareTest, ItsRobotsHaveItTogether) {
  FillUpTo(24);
  EXPECT_EQ(RoomOf(1, gateway_), Room::kFree);
  FillUpTo(25);
  EXPECT_EQ(RoomOf(1, gateway_), Room::kShareFull);
  EXPECT_EQ(RoomOf(1, nullptr), Room::kFree) << "a robot by itself";
  EXPECT_EQ(RoomOf(1, inbox.GatewayOf("CN=yard")), Room::kFree) << "another gateway's";
}

TEST_F(GatewayShareTest, EachOfThemMayAppendOneRecordThoughOthersFilledIt) {
  FillUpTo(49);
  EXPECT_EQ(RoomOf(0, gateway_), Room::kFree);
  FillUpTo(50);
  EXPECT_EQ(RoomOf(0, gateway_), Room::kFull) << "half of the journal is for the others";
  EXPECT_EQ(RoomOf(0, nullptr), Room::kFree);
  EXPECT_TRUE(inbox.HasRoom());
}

TEST_F(GatewayShareTest, IsOfBytesToo) {
  const JournalLimits limits{.bytes_max = 8000, .robot_share = 4, .gateway_share = 4};
  Inbox other(limits, clock);
  const GatewayRef gateway = other.GatewayOf("CN=hall");
  RecordingClient& robot = NewRobot();
  other.AppendMessage(robot, {robot.generation(), gateway}, {RecordOf(robot, 1)}, clock.Steady());
  const std::size_t left = 2000 - gateway->bytes();
  const robot::JournalUse one{.records = 1, .bytes = 0};
  EXPECT_EQ(other.RoomFor(one, left, gateway.get()), Room::kFree);
  EXPECT_EQ(other.RoomFor(one, left + 1, gateway.get()), Room::kShareFull);
  EXPECT_EQ(other.RoomFor({}, 9000, gateway.get()), Room::kFree) << "one passes, whatever its size";
}

TEST_F(GatewayShareTest, IsNeverLessThanARobotMayHave) {
  Inbox whole({.records_max = 10, .robot_share = 1}, clock);
  const GatewayRef gateway = whole.GatewayOf("CN=hall");
  RecordingClient& robot = NewRobot();
  for (model::Seq seq = 1; seq <= 9; ++seq) {
    whole.AppendMessage(robot, {robot.generation(), gateway}, {RecordOf(robot, seq)},
                        clock.Steady());
  }
  EXPECT_EQ(whole.RoomFor({.records = 9, .bytes = 0}, 1, gateway.get()), Room::kFree);
}

TEST_F(GatewayShareTest, AStreamThatWaitsForItIsWokenOnceThereIsRoom) {
  const loop::StreamRef stream{.inbox = &wakes_, .stream = 9};
  FillUpTo(50);
  inbox.WhenRoom(stream, gateway_);
  inbox.WhenRoom(stream, gateway_);
  EXPECT_EQ(wakes_.wakes(9), 0) << "the journal has room, and its gateway none";
  Append(honest_, kHonest);
  GatheredBatch batch = Fill(2);
  EXPECT_THAT(SeqsOf(batch.batch()), Contains(kHonest));
  Drop(std::move(batch));
  EXPECT_EQ(wakes_.wakes(9), 1);
  Drop(Fill(2));
  EXPECT_EQ(wakes_.wakes(9), 1) << "once per request";
  inbox.WhenRoom(stream, gateway_);
  EXPECT_EQ(wakes_.wakes(9), 2) << "at once where there is room";
}

TEST_F(GatewayShareTest, AStreamOfAnotherIsWokenThoughThisOneHasNoRoom) {
  const loop::StreamRef full{.inbox = &wakes_, .stream = 1};
  const loop::StreamRef other{.inbox = &wakes_, .stream = 2};
  FillUpTo(60);
  for (model::Seq seq = 0; seq < 40; ++seq) Append(honest_, kHonest + seq);
  ASSERT_FALSE(inbox.HasRoom());
  inbox.WhenRoom(full, gateway_);
  inbox.WhenRoom(other);
  Drop(Fill(4));
  EXPECT_EQ(wakes_.wakes(2), 1);
  EXPECT_EQ(wakes_.wakes(1), 0);
}

}  // namespace
}  // namespace uplink::journal
