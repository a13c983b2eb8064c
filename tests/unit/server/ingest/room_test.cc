#include "server/ingest/room.h"

#include <gtest/gtest.h>

#include "tests/unit/server/session/session_bench.h"

namespace uplink::ingest {
namespace {

using session::BenchLimits;
using session::BenchServer;
using session::SessionOf;

class HoldTest : public ::testing::Test {
 protected:
  HoldTest() { static_cast<void>(robot_.sessions.Begin(SessionOf(1), clock_.Steady())); }
  Block Of(Waits waits, const RecordCost& cost, const journal::GatewayRef& gateway = nullptr) {
    return FindBlock({.robot = robot_,
                      .id = robot_.id(),
                      .journal = server_.journal(),
                      .session = SessionOf(1),
                      .by = {0, gateway}},
                     waits, cost,
                     {.clock = clock_,
                      .flow = flow_,
                      .in_flight_max = in_flight_max_,
                      .journal_over_half = over_half_});
  }
  Block OfRecord(const RecordCost& cost) { return Of(Waits::kStream, cost); }
  /// One more message of the robot waits for its commit.
  void AddWaiting(std::size_t bytes) {
    EXPECT_EQ(robot_.sessions.AddWaiting(SessionOf(1), ++seq_, bytes), 1);
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_{.journal = {.bytes_max = 64'000}};
  BenchServer server_{clock_, database_, 1, limits_};
  const robot::PresenceChanged changed_;
  robot::Robot robot_{
      std::make_shared<const model::RobotId>(model::RobotId{std::string(session::kRobot)}),
      clock_.Steady(), clock_, changed_};
  robot::FlowLimits flow_{.records = {.rate = 1, .burst = 2}, .bytes = {}};
  model::Seq seq_ = 0;
  std::size_t in_flight_max_ = 1'000;
  bool over_half_ = false;
};

TEST_F(HoldTest, ARecordWaitsAtTheBoundOfItsRobot) {
  in_flight_max_ = 2;
  AddWaiting(1);
  EXPECT_TRUE(OfRecord({.journal_bytes = 1}).none());
  AddWaiting(1);
  EXPECT_EQ(OfRecord({.journal_bytes = 1}).by, HeldBack::kInFlight);
}

TEST_F(HoldTest, WhatWaitsOfTheRobotsCallsCountsInItsBounds) {
  in_flight_max_ = 2;
  AddWaiting(1);
  robot_.calls.AddWaiting({.records = 1, .bytes = 1});
  EXPECT_EQ(OfRecord({.journal_bytes = 1}).by, HeldBack::kInFlight);
  robot_.calls.EndWaiting({.records = 1, .bytes = 1});
  EXPECT_TRUE(OfRecord({.journal_bytes = 1}).none());
}

TEST_F(HoldTest, ARecordWaitsAtTheRobotsShareOfTheJournal) {
  EXPECT_TRUE(OfRecord({.journal_bytes = 1'000'000}).none()) << "one passes, whatever its size";
  AddWaiting(1'000);
  EXPECT_TRUE(OfRecord({.journal_bytes = 1'000}).none()) << "a 32nd of 64,000";
  EXPECT_EQ(OfRecord({.journal_bytes = 1'001}).by, HeldBack::kJournalShare);
  EXPECT_TRUE(server_.journal().HasRoom()) << "for everybody else";
}

TEST_F(HoldTest, ARecordWaitsAtItsGatewaysShareOfTheJournal) {
  const journal::GatewayRef gateway = server_.journal().GatewayOf("CN=hall");
  const auto of_record = [&] { return Of(Waits::kStream, {.journal_bytes = 1'000}, gateway).by; };
  AddWaiting(1);
  EXPECT_EQ(of_record(), HeldBack::kNone);
  // Another robot of the gateway: a quarter of 64,000.
  const journal::GatewayPlace sibling(gateway, 15'001);
  EXPECT_EQ(of_record(), HeldBack::kJournalShare);
  EXPECT_EQ(OfRecord({.journal_bytes = 1'000}).by, HeldBack::kNone) << "through no gateway";
}

TEST_F(HoldTest, ARecordOverTheFlowWaitsForItsTime) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(OfRecord({.journal_bytes = 1, .flow_bytes = 1}).none());
    robot_.flow.Take(1, flow_, clock_.Steady());
  }
  const Block block = OfRecord({.journal_bytes = 1, .flow_bytes = 1});
  EXPECT_EQ(block.by, HeldBack::kFlow);
  EXPECT_EQ(block.until, clock_.Steady() + std::chrono::seconds(1));
  EXPECT_TRUE(OfRecord({.journal_bytes = 1}).none()) << "quarantine costs nothing";
  EXPECT_FALSE(OfRecord({.journal_bytes = 1, .flow_bytes = 0}).none()) << "a gap is a row";
}

TEST_F(HoldTest, PastItsFlowAMessageThatNobodyWaitsForIsExcess) {
  const RecordCost cost{.journal_bytes = 1, .flow_bytes = 1};
  for (int i = 0; i < 2; ++i) robot_.flow.Take(1, flow_, clock_.Steady());
  const Block block = Of(Waits::kNoOne, cost);
  EXPECT_EQ(block.by, HeldBack::kFlow);
  EXPECT_TRUE(block.is_excess);
  EXPECT_TRUE(Of(Waits::kBroker, cost).none()) << "a backlog is honest";
  over_half_ = true;
  EXPECT_TRUE(Of(Waits::kBroker, cost).is_excess) << "it would hold back all others";
  EXPECT_FALSE(Of(Waits::kStream, cost).is_excess) << "its stream waits";
  EXPECT_TRUE(Of(Waits::kNoOne, {.journal_bytes = 1}).none()) << "the flow does not count it";
}

TEST_F(HoldTest, WhereNothingMayBeStoredEveryMessageWaits) {
  robot_.flow.LimitForDisk(0);
  for (const Waits waits : {Waits::kStream, Waits::kBroker, Waits::kNoOne}) {
    const Block block = Of(waits, {.journal_bytes = 1, .flow_bytes = 1});
    EXPECT_EQ(block.by, HeldBack::kDisk);
    EXPECT_FALSE(block.is_excess) << "it is no matter of this robot";
  }
}

TEST_F(HoldTest, TheShareOfARobotHoldsNoBrokerBack) {
  AddWaiting(2'000);
  const RecordCost cost{.journal_bytes = 1'000};
  EXPECT_EQ(Of(Waits::kStream, cost).by, HeldBack::kJournalShare);
  EXPECT_EQ(Of(Waits::kNoOne, cost).by, HeldBack::kJournalShare);
  EXPECT_TRUE(Of(Waits::kBroker, cost).none());
}

}  // namespace
}  // namespace uplink::ingest
