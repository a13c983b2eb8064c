#include "tools/uplink-fleet/robot/agent.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::synthetic {
namespace {

using ::testing::HasSubstr;

/// One agent at ten ticks a second and a server that answers as the test says.
class AgentTest : public ::testing::Test {
 protected:
  static Phase PhaseOf(std::size_t batch) {
    Phase phase;
    phase.options.run = "test";
    phase.options.faults_hz = 10;
    phase.options.malformed_share = 0.2;
    phase.batch = batch;
    return phase;
  }

  Agent Make(std::size_t batch = 1) { return Make(PhaseOf(batch)); }
  Agent Make(const Phase& phase) {
    return {phase, 0, model::SessionId(std::array<std::uint8_t, 16>{1}), shared_, latencies_};
  }

  void Welcome(Agent& agent) {
    static_cast<void>(agent.BeginStream());
    v1::RelayResponse frame;
    frame.mutable_welcome()->mutable_limits()->set_batch_uplinks_max(256);
    frame.mutable_welcome()->mutable_limits()->set_frame_bytes_max(1 << 20);
    ASSERT_TRUE(agent.OnFrame(frame, clock_.Steady()).ok());
  }

  void Tick(Agent& agent) {
    clock_.Advance(milliseconds(100));
    agent.Tick(clock_.Steady(), clock_.System());
  }

  /// Takes every frame that is due; the highest number sent, and how many frames it took.
  int Take(Agent& agent) {
    int frames = 0;
    while (const auto frame = agent.NextFrame(clock_.Steady(), clock_.System())) {
      EXPECT_GT(frame->batch().sent_unix_ms(), 0);
      for (const v1::Uplink& uplink : frame->batch().uplinks()) highest_ = uplink.seq();
      ++frames;
    }
    return frames;
  }

  void Ack(Agent& agent) {
    v1::RelayResponse frame;
    frame.mutable_ack()->set_through_seq(highest_);
    frame.mutable_ack()->set_judged_seq(highest_);
    ASSERT_TRUE(agent.OnFrame(frame, clock_.Steady()).ok());
  }

  testing::ManualClock clock_;
  Shared shared_;
  Latencies latencies_;
  model::Seq highest_ = 0;
};

TEST_F(AgentTest, GathersABatchForASecondAtMost) {
  Agent agent = Make(100);
  Welcome(agent);
  for (int i = 0; i < 10; ++i) {
    Tick(agent);
    EXPECT_EQ(Take(agent), 0) << i;
  }
  Tick(agent);
  EXPECT_EQ(Take(agent), 1);
  EXPECT_GE(highest_, 11U);
  Tick(agent);
  EXPECT_EQ(Take(agent), 0);
}

TEST_F(AgentTest, SaysHowFarBehindItIs) {
  Agent agent = Make();
  for (int i = 0; i < 300; ++i) Tick(agent);
  Welcome(agent);
  const auto first = agent.NextFrame(clock_.Steady(), clock_.System());
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->batch().has_backlog_uplinks());
  EXPECT_GT(first->batch().backlog_uplinks(), 0U);
  const std::int64_t waits = first->batch().sent_unix_ms() - first->batch().oldest_unsent_unix_ms();
  EXPECT_GT(waits, 0);
  EXPECT_LT(waits, 30'000);
  auto last = first;
  while (const auto frame = agent.NextFrame(clock_.Steady(), clock_.System())) last = frame;
  EXPECT_TRUE(last->batch().has_backlog_uplinks()) << "that nothing waits is said, too";
  EXPECT_EQ(last->batch().backlog_uplinks(), 0U);
  EXPECT_EQ(last->batch().oldest_unsent_unix_ms(), 0);
}

TEST_F(AgentTest, AFullBatchGoesAtOnce) {
  Agent agent = Make(2);
  Welcome(agent);
  Tick(agent);
  Tick(agent);
  EXPECT_EQ(Take(agent), 1);
}

TEST_F(AgentTest, GoesThroughTheStagesAndClosesOnlyWhenAllIsSettled) {
  Agent agent = Make();
  Welcome(agent);
  for (int i = 0; i < 50; ++i) {
    Tick(agent);
    Take(agent);
  }
  shared_.stage = Stage::kSettle;
  Tick(agent);
  Take(agent);
  EXPECT_EQ(shared_.settled_robots.load(), 0U);
  Ack(agent);
  Tick(agent);
  Tick(agent);
  EXPECT_EQ(shared_.settled_robots.load(), 1U);
  const model::Seq before = highest_;
  shared_.stage = Stage::kLast;
  for (int i = 0; i < 20; ++i) Tick(agent);
  Take(agent);
  EXPECT_EQ(highest_, before) << "nothing before the first round";
  shared_.last_round = 1;
  Tick(agent);
  Take(agent);
  EXPECT_GE(highest_, before + 2);
  EXPECT_EQ(shared_.last_robots.load(), 0U);
  Ack(agent);
  Tick(agent);
  EXPECT_EQ(shared_.last_robots.load(), 1U);
  const model::Seq first_round = highest_;
  shared_.last_round = 2;  // the server was started anew before it was looked at
  Tick(agent);
  Take(agent);
  EXPECT_GE(highest_, first_round + 2);
  EXPECT_EQ(shared_.last_robots.load(), 1U);
  Ack(agent);
  Tick(agent);
  EXPECT_EQ(shared_.last_robots.load(), 2U);
  const model::Seq looked_at = highest_;
  for (int i = 0; i < 10; ++i) Tick(agent);
  Take(agent);
  EXPECT_EQ(highest_, looked_at + 1) << "a sign of life while others are looked at";
  EXPECT_EQ(shared_.last_robots.load(), 2U);
  Ack(agent);
  EXPECT_FALSE(agent.may_close());
  shared_.stage = Stage::kClose;
  EXPECT_TRUE(agent.may_close());
  agent.OnEndedOk();
  EXPECT_EQ(shared_.rules_broken.load(), 0U);
}

TEST_F(AgentTest, CountsItsOwnSilences) {
  Agent agent = Make();
  Welcome(agent);
  Tick(agent);
  Take(agent);
  clock_.Advance(milliseconds(2'900));
  Tick(agent);
  Take(agent);
  clock_.Advance(milliseconds(2'901));
  Tick(agent);
  Take(agent);
  EXPECT_EQ(agent.TakeOutcome("rcan://test").silences, 1U);
}

TEST_F(AgentTest, EndingOkWithUnsettledMessagesBreaksARule) {
  Agent agent = Make();
  Welcome(agent);
  Tick(agent);
  Take(agent);
  agent.OnEndedOk();
  EXPECT_EQ(shared_.rules_broken.load(), 1U);
  EXPECT_THAT(shared_.first_broken_rule.Read(), HasSubstr("unsettled"));
}

TEST_F(AgentTest, TheAccountKnowsWhatWasAckedAndWhatWasTold) {
  Agent agent = Make();
  Welcome(agent);
  for (int i = 0; i < 200; ++i) {
    Tick(agent);
    Take(agent);
  }
  v1::RelayResponse reject;
  reject.mutable_reject()->set_reason(v1::REJECT_REASON_MALFORMED);
  for (model::Seq seq = 1; seq <= highest_; ++seq) {
    reject.mutable_reject()->set_seq(seq);
    ASSERT_TRUE(agent.OnFrame(reject, clock_.Steady()).ok());
  }
  Ack(agent);
  const RobotOutcome outcome = agent.TakeOutcome("rcan://test");
  EXPECT_EQ(outcome.last_seq, highest_);
  EXPECT_TRUE(outcome.all_settled);
  ASSERT_FALSE(outcome.account.wrongs().empty());
  for (const auto& [tag, wrong] : outcome.account.wrongs()) {
    EXPECT_TRUE(wrong.acked);
    ASSERT_TRUE(wrong.told.has_value());
    EXPECT_EQ(wrong.told->reason, model::RejectReason::kMalformed);
  }
  ASSERT_GT(outcome.account.good(), 10U);
  EXPECT_EQ(outcome.account.good_rejected(), outcome.account.good());
  // What is shown while it runs is what the comparison counts: without the wrong ones.
  EXPECT_EQ(shared_.acked_durable.load(), outcome.account.good_acked());
  EXPECT_EQ(shared_.acked_durable.load(), outcome.account.good());
  EXPECT_EQ(outcome.mark, "test-1");
}

TEST_F(AgentTest, AFloodGoesAsFarAsAcksLetIt) {
  Phase phase = PhaseOf(64);
  phase.flood = true;
  phase.options.faults_hz = 0;
  phase.options.malformed_share = 0;
  Agent agent = Make(phase);
  agent.Fill(clock_.Steady(), clock_.System());
  EXPECT_EQ(Take(agent), 0) << "not before the Welcome";
  Welcome(agent);
  int frames = 0;
  do {
    agent.Fill(clock_.Steady(), clock_.System());
    frames = Take(agent);
  } while (frames > 0);
  EXPECT_EQ(highest_, kFloodAhead);
  Ack(agent);
  agent.Fill(clock_.Steady(), clock_.System());
  EXPECT_EQ(Take(agent), 1);
  EXPECT_EQ(highest_, kFloodAhead + 64);
}

TEST_F(AgentTest, ARobotThatWasOfflineComesWithWhatItKept) {
  Phase phase = PhaseOf(1);
  phase.options.malformed_share = 0;
  Agent agent = Make(phase);
  agent.LiveOffline(std::chrono::hours(1), phase.tick(), clock_.System());
  agent.Begin(clock_.Steady());
  Welcome(agent);
  while (Take(agent) > 0) Ack(agent);
  const RobotOutcome outcome = agent.TakeOutcome("rcan://a/1");
  EXPECT_GT(outcome.account.good(), 36'000U) << "an hour of ten ticks a second";
  EXPECT_EQ(latencies_.gave_way.count(), 0U) << "without a connection no message waits";
  EXPECT_EQ(outcome.sent, outcome.account.good() + kLiveWaitingMax);
}

TEST_F(AgentTest, ARobotThatKeepsAllItMayOnlyMoves) {
  Phase phase = PhaseOf(1);
  phase.options.malformed_share = 0;
  phase.options.faults_hz = 1000;
  Agent agent = Make(phase);
  agent.LiveOffline(std::chrono::minutes(10), phase.tick(), clock_.System());
  agent.Begin(clock_.Steady());
  EXPECT_EQ(shared_.only_moving.load(), 1U);
  Welcome(agent);
  while (Take(agent) > 0) Ack(agent);
  const RobotOutcome outcome = agent.TakeOutcome("rcan://a/1");
  EXPECT_LT(outcome.account.good(), kDurableWaitingMax);
  EXPECT_EQ(outcome.account.good_acked(), outcome.account.good()) << "nothing was refused";
  EXPECT_EQ(latencies_.durable.max(), Histogram::Micros(0)) << "due when the run begins";
  EXPECT_EQ(outcome.judged, outcome.sent);
}

TEST_F(AgentTest, WhatGaveWayIsMeasuredToo) {
  Phase phase = PhaseOf(1);
  phase.options.malformed_share = 0;
  phase.options.faults_hz = 0;
  Agent agent = Make(phase);
  // A minute without a stream: the newest are kept.
  for (int i = 0; i < 600; ++i) Tick(agent);
  EXPECT_GT(latencies_.gave_way.count(), 600 - kLiveWaitingMax);
  EXPECT_GE(latencies_.gave_way.max(), std::chrono::seconds(15));
  EXPECT_EQ(latencies_.live.count(), 0U);
}

TEST_F(AgentTest, LatencyRunsFromWhenAMessageWasDue) {
  Phase phase = PhaseOf(1);
  phase.options.malformed_share = 0;
  Agent agent = Make(phase);
  // The stream is away for half a second.
  for (int i = 0; i < 5; ++i) Tick(agent);
  Welcome(agent);
  while (Take(agent) > 0) {
  }
  clock_.Advance(milliseconds(10));
  Ack(agent);
  EXPECT_GT(latencies_.durable.count(), 0U);
  EXPECT_GT(latencies_.live.count(), 4U);
  EXPECT_EQ(latencies_.live.max(), milliseconds(410));
  EXPECT_LT(latencies_.live.Quantile(0), milliseconds(11));
}

TEST_F(AgentTest, APhaseChangesWhatIsSent) {
  Phase phase = PhaseOf(1);
  phase.options.malformed_share = 0;
  Agent agent = Make(phase);
  Welcome(agent);
  Tick(agent);
  EXPECT_GT(Take(agent), 0);
  phase.batch = 200;
  agent.Adopt(phase);
  Tick(agent);
  EXPECT_EQ(Take(agent), 0);
}

v1::RelayResponse ForwardOf(v1::ForwardKind kind) {
  v1::RelayResponse frame;
  frame.mutable_forward()->set_kind(kind);
  return frame;
}

TEST_F(AgentTest, DeclinesWhatOthersShareUnlessItReceives) {
  Agent agent = Make();
  EXPECT_TRUE(agent.BeginStream().hello().declines_forwards());
  Welcome(agent);
  EXPECT_THAT(agent.OnFrame(ForwardOf(v1::FORWARD_KIND_SNAPSHOT_BEGIN), clock_.Steady()).message(),
              HasSubstr("declines"));
  ForwardReader reader;
  Agent other = Make();
  other.Receive("rcan://test/1", reader);
  EXPECT_FALSE(other.BeginStream().hello().declines_forwards());
}

TEST_F(AgentTest, MeasuresTheFirstSnapshotOfAStreamAndShowsItsTableWhenAsked) {
  ForwardReader reader;
  Agent agent = Make();
  agent.Receive("rcan://test/1", reader);
  agent.JoinLate();
  for (int stream = 0; stream < 2; ++stream) {
    Welcome(agent);
    clock_.Advance(milliseconds(100));
    for (const auto kind : {v1::FORWARD_KIND_SNAPSHOT_BEGIN, v1::FORWARD_KIND_SNAPSHOT_END,
                            v1::FORWARD_KIND_SNAPSHOT_BEGIN, v1::FORWARD_KIND_SNAPSHOT_END}) {
      EXPECT_TRUE(agent.OnFrame(ForwardOf(kind), clock_.Steady()).ok());
    }
  }
  EXPECT_EQ(latencies_.snapshot.count(), 2U) << "one per stream";
  EXPECT_EQ(latencies_.late_snapshot.count(), 1U) << "one per robot";
  EXPECT_GE(latencies_.snapshot.max(), milliseconds(100));
  shared_.stage.store(Stage::kLast);
  Tick(agent);
  EXPECT_EQ(shared_.forwards.shown(), 0U) << "not asked for";
  for (std::size_t asked = 1; asked <= 2; ++asked) {
    shared_.forwards.Ask();
    Tick(agent);
    Tick(agent);
    const auto tables = shared_.forwards.Take();
    ASSERT_EQ(tables.size(), 1U);
    EXPECT_EQ(tables[0].ruri, "rcan://test/1");
    EXPECT_TRUE(tables[0].whole);
  }
  EXPECT_EQ(agent.TakeOutcome("rcan://test/1").forwarded_snapshots, 4U);
}

}  // namespace
}  // namespace uplink::synthetic
