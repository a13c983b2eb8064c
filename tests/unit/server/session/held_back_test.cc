#include "server/session/held_back.h"

#include <gtest/gtest.h>

#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {
namespace {

class HoldTest : public ::testing::Test {
 protected:
  HoldTest() { static_cast<void>(robot_.sessions.Begin(SessionOf(1), clock_.Steady())); }
  HeldBackSources Sources() {
    return {.robot = robot_,
            .journal = server_.journal(),
            .limits = limits_.session,
            .flow = flow_,
            .clock = clock_};
  }
  HeldBack OfAll(std::size_t outgoing = 0) { return HoldOfAll(Sources(), outgoing).by; }
  Hold OfRecord(const RecordCost& cost) { return HoldOfRecord(Sources(), cost); }
  /// One more message of the robot waits for its commit.
  void AddWaiting(std::size_t bytes) {
    EXPECT_EQ(robot_.sessions.AddWaiting(SessionOf(1), ++seq_, bytes), 1);
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_{.journal = {.bytes_max = 64'000}};
  BenchServer server_{clock_, database_, 1, limits_};
  const robot::PresenceChanged changed_;
  robot::Robot robot_{std::make_shared<const model::RobotId>(model::RobotId{std::string(kRobot)}),
                      clock_.Steady(), clock_, changed_};
  robot::FlowLimits flow_{.records = {.rate = 1, .burst = 2}, .bytes = {}};
  model::Seq seq_ = 0;
};

TEST_F(HoldTest, ARecordWaitsAtTheBoundOfItsRobot) {
  limits_.session.in_flight_uplinks_max = 2;
  AddWaiting(1);
  EXPECT_TRUE(OfRecord({.journal_bytes = 1}).none());
  AddWaiting(1);
  EXPECT_EQ(OfRecord({.journal_bytes = 1}).by, HeldBack::kInFlight);
  EXPECT_EQ(OfAll(), HeldBack::kNone) << "live messages go on";
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
  HeldBackSources sources = Sources();
  sources.gateway = gateway.get();
  const auto of_record = [&] { return HoldOfRecord(sources, {.journal_bytes = 1'000}).by; };
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
  const Hold hold = OfRecord({.journal_bytes = 1, .flow_bytes = 1});
  EXPECT_EQ(hold.by, HeldBack::kFlow);
  EXPECT_EQ(hold.until, clock_.Steady() + std::chrono::seconds(1));
  EXPECT_TRUE(OfRecord({.journal_bytes = 1}).none()) << "quarantine costs nothing";
  EXPECT_FALSE(OfRecord({.journal_bytes = 1, .flow_bytes = 0}).none()) << "a gap is a row";
}

TEST_F(HoldTest, AStreamWhosePeerDoesNotReadIsHeldBack) {
  EXPECT_EQ(OfAll(kOutgoingFramesMax - 1), HeldBack::kNone);
  EXPECT_EQ(OfAll(kOutgoingFramesMax), HeldBack::kUnread);
}

TEST_F(HoldTest, AThrottledStreamIsHeldBackUntilItsEnd) {
  for (std::uint32_t i = 0; i <= robot::kRejectsPerSecondMax; ++i) {
    robot_.throttle.Add(clock_.Steady());
  }
  EXPECT_EQ(OfAll(), HeldBack::kMalformed);
  EXPECT_EQ(OfAll(kOutgoingFramesMax), HeldBack::kUnread) << "the first that applies";
  clock_.Advance(std::chrono::seconds(1));
  EXPECT_EQ(OfAll(), HeldBack::kNone);
}

}  // namespace
}  // namespace uplink::session
