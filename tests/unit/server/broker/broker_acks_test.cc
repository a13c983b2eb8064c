// What the broker's reader acks, and what comes again.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/broker.h"
#include "server/broker/limits.h"
#include "tests/unit/server/broker/broker_world.h"

namespace uplink::broker {
namespace {

using testing::FakeLink;
using ::testing::SizeIs;

class BrokerAcksTest : public BrokerWorld {
 protected:
  /// The durable connection breaks, and the next one is subscribed.
  std::shared_ptr<FakeLink> Again() {
    durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
    std::shared_ptr<FakeLink> again = links_.back();
    clock_.Advance(std::chrono::seconds(5));
    again->events()->OnDue();
    Up(again, true);
    return again;
  }
  /// They name no error.
  static std::string Metrics(const std::string& twin, std::size_t id, bool dup = false) {
    return testing::PublishBytes{.topic = "cyberwave/twin/" + twin + "/metrics",
                                 .payload = R"({"metrics":{"errors":[]}})",
                                 .id = id,
                                 .dup = dup,
                                 .mqtt5 = false}
        .Text();
  }
};

TEST_F(BrokerAcksTest, AcksWhatIsCommittedAndNothingBefore) {
  Connect();
  durable()->Bring(Event(1, 5));
  Flush(*durable());
  EXPECT_EQ(durable()->written, "");
  Run();
  EXPECT_EQ(durable()->written, Puback(5));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(BrokerAcksTest, AMessageAtQos1OnTheLiveConnectionIsAckedAndHoldsNothing) {
  Connect();
  store_.FailNextCommits(1'000, testing::FailAt::kBefore);
  for (std::size_t id = 1; id <= 3; ++id) durable()->Bring(Event(static_cast<int>(id), id));
  live()->Bring(Event(9, 9));
  Flush(*live());
  EXPECT_EQ(live()->written, Puback(9));
  EXPECT_EQ(Count(Became::kRefused), 1U);
  EXPECT_TRUE(live()->reading);
}

TEST_F(BrokerAcksTest, ARedeliveryAfterAReconnectIsStoredOnceAndAckedThere) {
  Connect();
  durable()->Bring(Event(1, 5));
  durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  const std::shared_ptr<FakeLink> again = links_.back();
  clock_.Advance(std::chrono::seconds(5));
  again->events()->OnDue();
  ASSERT_TRUE(again->opened);
  Up(again, true);
  again->Bring(Event(1, 5, true));
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
  EXPECT_EQ(Stored(), 1U);
  EXPECT_EQ(Count(Became::kDuplicate), 1U);
}

TEST_F(BrokerAcksTest, ARedeliveryOfWhatIsStoredIsAckedOnceTheStoreHasAnswered) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  const std::shared_ptr<FakeLink> again = Again();
  store_.FailNextCommits(1, testing::FailAt::kBefore);
  again->Bring(Event(1, 5, true));
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, "") << "the store is away";
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(BrokerAcksTest, ARedeliveryBeforeAFailoverIsNotAckedForWhatTheNewPrimaryLacks) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  const std::shared_ptr<FakeLink> again = Again();
  const std::string other = TwinOfAnotherShard();
  // Its commit is told, and the broker's thread has not looked yet.
  again->Bring(EventOf(other, 2, 6));
  Write(JournalOf(other));
  again->Bring(Event(1, 5, true));
  store_.Break();
  for (journal::Journal* journal : shards_.all()) Write(*journal);
  Posted();
  Run();
  EXPECT_TRUE(again->closed);
  EXPECT_EQ(again->written.find(Puback(5)), std::string::npos);
  broker_.Resume({lease_.reread_asked, {}, {}});
  const std::shared_ptr<FakeLink> third = links_.back();
  Up(third, true);
  third->Bring(Event(1, 5, true));
  Run();
  Flush(*third);
  EXPECT_EQ(third->written, Puback(5));
  EXPECT_EQ(Stored(), 3U) << "stored anew";
}

TEST_F(BrokerAcksTest, MetricsThatChangeNoFaultWaitForACommitOfTheirOwnShard) {
  Connect();
  const std::string other = TwinOfAnotherShard();
  for (const std::string& twin : {std::string(kTwin), other}) {
    durable()->Bring(Metrics(twin, 5));
    for (journal::Journal* journal : shards_.all()) {
      if (journal != &JournalOf(twin)) Write(*journal);
    }
    Posted();
    Flush(*durable());
    EXPECT_EQ(durable()->written, "") << twin;
    Run();
    Flush(*durable());
    EXPECT_EQ(durable()->written, Puback(5)) << twin;
    durable()->written.clear();
  }
  EXPECT_EQ(Count(Became::kApplied), 2U);
}

TEST_F(BrokerAcksTest, MetricsBeforeAFailoverAreNotAckedForFaultsThatTheNewPrimaryMayLack) {
  Connect();
  durable()->Bring(Metrics(kTwin, 5));
  store_.Break();
  Run();
  Flush(*durable());
  EXPECT_TRUE(durable()->closed);
  EXPECT_EQ(durable()->written.find(Puback(5)), std::string::npos);
  broker_.Resume({lease_.reread_asked, {}, {}});
  const std::shared_ptr<FakeLink> again = links_.back();
  Up(again, true);
  again->Bring(Metrics(kTwin, 5, true));
  EXPECT_EQ(Count(Became::kDuplicate), 0U) << "they are judged again";
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
}

TEST_F(BrokerAcksTest, AcksInOrderOfArrivalWhicheverShardCommitsFirst) {
  Connect();
  const std::string other = TwinOfAnotherShard();
  durable()->Bring(Event(1, 5) + EventOf(other, 2, 6) + Event(3, 7));
  Write(JournalOf(other));
  Posted();
  EXPECT_EQ(Stored(), 1U);
  EXPECT_EQ(durable()->written, "") << "5 came before it, and is not committed";
  Run();
  Flush(*durable());
  EXPECT_EQ(durable()->written, Puback(5) + Puback(6) + Puback(7));
  EXPECT_EQ(Stored(), 3U);
}

TEST_F(BrokerAcksTest, WhatAnotherShardCommittedFirstIsKnownWhenAllComesAgain) {
  Connect();
  const std::string other = TwinOfAnotherShard();
  durable()->Bring(Event(1, 5) + EventOf(other, 2, 6));
  Write(JournalOf(other));
  Posted();
  durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  const std::shared_ptr<FakeLink> again = links_.back();
  clock_.Advance(std::chrono::seconds(5));
  again->events()->OnDue();
  Up(again, true);
  again->Bring(Event(1, 5, true) + EventOf(other, 2, 6, true));
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5) + Puback(6));
  EXPECT_EQ(Stored(), 2U);
}

TEST_F(BrokerAcksTest, WhatWaitsWhenTheBrokerLosesTheSessionIsCommittedAndNotAcked) {
  Connect();
  durable()->Bring(Event(1, 5));
  durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  const std::shared_ptr<FakeLink> again = links_.back();
  clock_.Advance(std::chrono::seconds(5));
  again->events()->OnDue();
  Up(again, false);
  Run();
  Flush(*again);
  EXPECT_EQ(Stored(), 1U);
  EXPECT_EQ(again->written, "") << "this connection never delivered it";
  EXPECT_EQ(Count(Became::kStored), 1U);
}

TEST_F(BrokerAcksTest, ASessionThatTheBrokerLostEndsWhatWasKnown) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  const std::shared_ptr<FakeLink> again = links_.back();
  clock_.Advance(std::chrono::seconds(5));
  again->events()->OnDue();
  Up(again, false);
  again->Bring(Event(1, 5, true));
  Run();
  EXPECT_EQ(Stored(), 2U) << "by a new session it is another message";
}

TEST_F(BrokerAcksTest, ARobotThatAnotherTookMakesTheConnectionAnew) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  durable()->Bring(Event(2, 6));
  // Another process takes the lease; what waits is fenced.
  testing::FakeTopicLeases other(database_, {2});
  ASSERT_TRUE((*other.Take({.client_id = "core",
                            .prefixes = {""},
                            .over = {{.process = {1}, .lease_counter = 0}},
                            .at = clock_.System(),
                            .unacked_max = 8}))
                  .has_value());
  Run();
  Run();
  EXPECT_TRUE(durable()->closed);
  EXPECT_EQ(durable()->written.find(Puback(6)), std::string::npos);
  EXPECT_EQ(Count(Became::kRefused), 1U);
  EXPECT_EQ(Stored(), 1U);
  EXPECT_EQ(lease_.rereads, 1);
  EXPECT_THAT(links_, SizeIs(2)) << "no connection before the store has said what it has";
  broker_.Resume({lease_.reread_asked, *leases_.MemoryOf("core"), {}});
  EXPECT_THAT(links_, SizeIs(3));
}

TEST_F(BrokerAcksTest, ARedeliveryIsAckedFromMemoryNoMoreOnceTheStoreWasConnectedToAnew) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  Flush(*durable());
  ASSERT_EQ(durable()->written, Puback(5));
  broker_.Reread();
  Posted();
  EXPECT_TRUE(durable()->closed);
  EXPECT_EQ(lease_.rereads, 1);
  broker_.Reread();
  broker_.Resume({lease_.reread_asked - 1, *leases_.MemoryOf("core"), {}});
  EXPECT_THAT(links_, SizeIs(2)) << "that was read before it was asked for last";
  // The new primary lacks the delivery.
  broker_.Resume({lease_.reread_asked, {}, {}});
  const std::shared_ptr<FakeLink> again = links_.back();
  Up(again, true);
  again->Bring(Event(1, 5, true));
  Flush(*again);
  EXPECT_EQ(again->written, "") << "it is new";
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
  EXPECT_EQ(Count(Became::kStored), 2U);
}

TEST_F(BrokerAcksTest, WhatIsSettledWhileTheStoreIsReadAgainIsAckedByTheNextConnection) {
  Connect();
  durable()->Bring(Event(1, 5));
  broker_.Reread();
  // A commit that was under way is told now, perhaps with others that the new primary lacks.
  Run();
  EXPECT_EQ(durable()->written.find(Puback(5)), std::string::npos);
  broker_.Resume({lease_.reread_asked, {}, {}});
  const std::shared_ptr<FakeLink> again = links_.back();
  Up(again, true);
  again->Bring(Event(1, 5, true));
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
  EXPECT_EQ(Stored(), 1U) << "it was committed after that was asked";
}

TEST_F(BrokerAcksTest, WhatWasCommittedAndNotToldIsKnownAfterTheRobotWasTakenOver) {
  Connect();
  durable()->Bring(Event(1, 5));
  // It is committed; before that is told another process has the robot.
  static_cast<void>(JournalOf(kTwin).turns().Advance());
  static_cast<void>(JournalOf(kTwin).turns().Advance());
  ASSERT_EQ(Stored(), 1U);
  fleet_.All().at(0)->OnFenced(ledger_).Wake();
  Posted();
  EXPECT_EQ(Count(Became::kRefused), 1U);
  Run();
  broker_.Resume({lease_.reread_asked, *leases_.MemoryOf("core"), {}});
  const std::shared_ptr<FakeLink> again = links_.back();
  Up(again, true);
  again->Bring(Event(1, 5, true));
  Run();
  Flush(*again);
  EXPECT_EQ(again->written, Puback(5));
  EXPECT_EQ(Stored(), 1U);
}

TEST_F(BrokerAcksTest, AStreamThatAnOperatorEndedSettlesWhatWaitsAndGoes) {
  Connect();
  durable()->Bring(Event(1, 5));
  fleet_.All().at(0)->sessions.EndStream().Wake();
  Posted();
  EXPECT_EQ(broker_.waiting(), 1U);
  Run();
  Flush(*durable());
  EXPECT_EQ(durable()->written, Puback(5));
  EXPECT_FALSE(durable()->closed) << "nothing is lost, and nothing is to come again";
  EXPECT_EQ(Count(Became::kStored), 1U);
  EXPECT_FALSE(fleet_.All().at(0)->HasStream());
  EXPECT_EQ(twins_.size(), 0U);
  // It speaks on, and is not there again until it could be forgotten.
  durable()->Bring(Event(2, 6));
  Run();
  EXPECT_FALSE(fleet_.All().at(0)->HasStream());
  EXPECT_EQ(Stored(), 1U);
  clock_.Advance(kRestAfterDrop);
  broker_.Tick();
  Run();
  EXPECT_EQ(Stored(), 2U);
}

TEST_F(BrokerAcksTest, WhileTheStoreIsAskedNothingIsTakenThatComesAgain) {
  Connect();
  durable()->Bring(Event(1, 5));
  fleet_.All().at(0)->OnFenced(ledger_).Wake();
  // Not yet closed: what was read before is still there.
  durable()->Bring(Event(2, 6) + Event(3, 0));
  Posted();
  Run();
  EXPECT_EQ(Stored(), 0U);
  EXPECT_EQ(Count(Became::kRefused), 3U);
  EXPECT_TRUE(broker_.ledger().Read().messages.Balanced());
}

TEST_F(BrokerAcksTest, WithoutAnAckForASecondWeAreBehindThoughWeRead) {
  Connect();
  store_.FailNextCommits(1'000, testing::FailAt::kBefore);
  durable()->Bring(Event(1, 1));
  for (int second = 0; second < 5; ++second) {
    broker_.Tick();
    clock_.Advance(std::chrono::seconds(1));
  }
  EXPECT_TRUE(durable()->reading);
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kBehind);
  EXPECT_EQ(broker_.probe().behind.value(), 1);
}

}  // namespace
}  // namespace uplink::broker
