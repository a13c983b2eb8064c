// A robot's stream from Hello to its end, over the wire.
#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

std::vector<Sent> FaultsFrom(model::Seq first, std::size_t count) {
  std::vector<Sent> messages;
  for (std::size_t i = 0; i < count; ++i) {
    const model::Seq seq = first + i;
    messages.push_back({seq, FaultPayload("fault-" + std::to_string(seq))});
  }
  return messages;
}

std::vector<model::Seq> UpTo(model::Seq last) {
  std::vector<model::Seq> numbers(last);
  std::iota(numbers.begin(), numbers.end(), 1);
  return numbers;
}

TEST(Streams, WelcomeTellsTheLimits) {
  RelayWorld world({.session = {.payload_bytes_max = 131'072,
                                .batch_uplinks_max = 10,
                                .extras_items_max = 20,
                                .in_flight_uplinks_max = 30,
                                .frame_bytes_max = 400'000,
                                .server_version = "1.2.3"}});
  TestAgent agent(world.Channel(RuriOf(1)));
  const auto welcome = agent.Connect(SessionOf(1));
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->robot_ruri(), RuriOf(1));
  EXPECT_EQ(welcome->committed_seq(), 0U);
  EXPECT_EQ(welcome->server_version(), "1.2.3");
  EXPECT_GT(welcome->server_unix_ms(), 0);
  EXPECT_EQ(welcome->limits().payload_bytes_max(), 131'072U);
  EXPECT_EQ(welcome->limits().batch_uplinks_max(), 10U);
  EXPECT_EQ(welcome->limits().extras_items_max(), 20U);
  EXPECT_EQ(welcome->limits().in_flight_uplinks_max(), 30U);
  EXPECT_EQ(welcome->limits().frame_bytes_max(), 400'000U);
}

TEST(Streams, AnAckMeansStored) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame(FaultsFrom(1, 3)));
  ASSERT_TRUE(agent.ReadThrough(3));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, UpTo(3));
}

TEST(Streams, LiveMessagesAreAckedByTheTimer) {
  RelayWorld world({.session = {.ack_interval = milliseconds(20)}});
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame({{1, MotionPayload(1)}, {2, MotionPayload(2)}}));
  const auto ack = agent.ReadJudged(2);
  ASSERT_TRUE(ack);
  EXPECT_EQ(ack->through_seq(), 2U);
  const metrics::MessageCounts counts = world.Counts();
  EXPECT_EQ(counts.received, 2U);
  EXPECT_EQ(counts.applied + counts.superseded, 2U);
}

TEST(Streams, AnAgentTellsHowFarBehindItIsAndItsClock) {
  RelayWorld world;
  const auto state = [&world] {
    return world.fleet.Find(RuriOf(1))->state.Snapshot(robot::RobotState::Parts::kNone);
  };
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  // As an agent that knows nothing of it.
  agent.Send(BatchFrame(FaultsFrom(1, 1)));
  ASSERT_TRUE(agent.ReadThrough(1));
  EXPECT_FALSE(state().backlog);
  EXPECT_FALSE(state().clock_skew_ms);

  constexpr std::int64_t kHourMs = 3'600'000;
  v1::RelayRequest frame = BatchFrame(FaultsFrom(2, 1));
  v1::UplinkBatch& batch = *frame.mutable_batch();
  batch.set_sent_unix_ms(UnixMs(SystemClock().System()) - kHourMs);
  batch.set_backlog_uplinks(500);
  batch.set_oldest_unsent_unix_ms(batch.sent_unix_ms() - 60'000);
  agent.Send(frame);
  ASSERT_TRUE(agent.ReadThrough(2));
  const robot::StateSnapshot behind = state();
  ASSERT_TRUE(behind.backlog);
  EXPECT_EQ(behind.backlog->uplinks, 500U);
  EXPECT_EQ(behind.backlog->oldest_unsent, behind.backlog->said_at - milliseconds(60'000));
  ASSERT_TRUE(behind.clock_skew_ms);
  EXPECT_LE(*behind.clock_skew_ms, -kHourMs) << "too low by the way that the batch took";
  EXPECT_GT(*behind.clock_skew_ms, -2 * kHourMs);

  frame = BatchFrame(FaultsFrom(3, 1));
  frame.mutable_batch()->set_backlog_uplinks(0);
  agent.Send(frame);
  ASSERT_TRUE(agent.ReadThrough(3));
  EXPECT_EQ(state().backlog->uplinks, 0U);
  EXPECT_FALSE(state().backlog->oldest_unsent);
}

TEST(Streams, ARejectComesBeforeTheAckThatCoversIt) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame({{1, FaultPayload("a")}, {2, "no message"}, {3, FaultPayload("c")}}));
  ASSERT_TRUE(agent.ReadThrough(3));
  const auto is_reject = [](const v1::RelayResponse& frame) { return frame.has_reject(); };
  const auto covers = [](const v1::RelayResponse& frame) {
    return frame.has_ack() && (frame.ack().through_seq() >= 2 || frame.ack().judged_seq() >= 2);
  };
  const auto reject = std::find_if(agent.frames().begin(), agent.frames().end(), is_reject);
  const auto ack = std::find_if(agent.frames().begin(), agent.frames().end(), covers);
  ASSERT_NE(reject, agent.frames().end());
  EXPECT_LT(reject, ack);
  EXPECT_EQ(reject->reject().seq(), 2U);
  EXPECT_EQ(reject->reject().reason(), v1::REJECT_REASON_MALFORMED);
  EXPECT_TRUE(world.database.QuarantineReason(RuriOf(1), SessionOf(1), 2));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, (std::vector<model::Seq>{1, 3}));
}

TEST(Streams, HalfCloseSettlesAndEndsOk) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  world.store.Block();
  agent.Send(BatchFrame(FaultsFrom(1, 5)));
  agent.HalfClose();
  ASSERT_TRUE(world.store.WaitUntilBlocked(kPatience));
  world.store.Release();
  const grpc::Status status = agent.End();
  EXPECT_TRUE(status.ok()) << status.error_message();
  ASSERT_TRUE(agent.frames().back().has_ack());
  EXPECT_EQ(agent.frames().back().ack().through_seq(), 5U);
  EXPECT_TRUE(world.Settles());
}

TEST(Streams, ABrokenStreamResumesWithoutLossOrDouble) {
  RelayWorld world;
  const auto channel = world.Channel(RuriOf(1));
  {
    TestAgent agent(channel);
    ASSERT_TRUE(agent.Connect(SessionOf(1)));
    agent.Send(BatchFrame(FaultsFrom(1, 4)));
    ASSERT_TRUE(agent.ReadThrough(2));
    agent.Cancel();
  }
  TestAgent agent(channel);
  const auto welcome = agent.Connect(SessionOf(1), 2, 4);
  ASSERT_TRUE(welcome);
  EXPECT_GE(welcome->committed_seq(), 2U);
  agent.Send(BatchFrame(FaultsFrom(3, 4)));
  ASSERT_TRUE(agent.ReadThrough(6));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, UpTo(6));
  EXPECT_TRUE(world.Settles());
  EXPECT_EQ(world.Counts().missing, 0U);
}

TEST(Streams, WelcomeDoesNotWaitForTheStore) {
  RelayWorld world;
  world.store.Block();
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame({{1, FaultPayload("a")}}));
  world.store.Release();
  EXPECT_TRUE(agent.ReadThrough(1));
}

TEST(Streams, AFullJournalHoldsEveryStreamBack) {
  RelayWorld world({.session = {}, .journal = {.records_max = 8, .robot_share = 1}});
  TestAgent one(world.Channel(RuriOf(1)));
  TestAgent two(world.Channel(RuriOf(2)));
  ASSERT_TRUE(one.Connect(SessionOf(1)));
  ASSERT_TRUE(two.Connect(SessionOf(2)));
  world.store.Block();
  for (model::Seq seq = 1; seq <= 40; seq += 4) {
    ASSERT_TRUE(one.Send(BatchFrame(FaultsFrom(seq, 4))));
    ASSERT_TRUE(two.Send(BatchFrame(FaultsFrom(seq, 4))));
  }
  ASSERT_TRUE(Eventually([&] { return world.session_probe.held_back.value() == 2; }));
  world.store.Release();
  EXPECT_TRUE(one.ReadThrough(40));
  EXPECT_TRUE(two.ReadThrough(40));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, UpTo(40));
  EXPECT_EQ(world.database.Log(RuriOf(2), SessionOf(2)).stored, UpTo(40));
}

TEST(Streams, OneRobotAtItsShareOfTheJournalHoldsNobodyElseBack) {
  constexpr std::size_t kBytesMax = 256'000;
  RelayWorld world({.session = {}, .journal = {.bytes_max = kBytesMax}});
  TestAgent greedy(world.Channel(RuriOf(1)));
  TestAgent other(world.Channel(RuriOf(2)));
  ASSERT_TRUE(greedy.Connect(SessionOf(1)));
  ASSERT_TRUE(other.Connect(SessionOf(2)));
  world.store.Block();
  ASSERT_TRUE(greedy.Send(BatchFrame(FaultsFrom(1, 200))));
  const metrics::Cell& held =
      world.session_probe.held_back_by[static_cast<std::size_t>(robot::HeldBack::kJournalShare)];
  ASSERT_TRUE(Eventually([&] { return held.value() == 1; }));
  EXPECT_LE(world.journal.bytes(), kBytesMax / 32);
  ASSERT_TRUE(other.Send(BatchFrame({{1, MotionPayload()}, {2, FaultPayload("a")}})));
  ASSERT_TRUE(other.Send(BatchFrame({{3, MotionPayload()}})));
  EXPECT_TRUE(other.ReadJudged(3));
  EXPECT_EQ(world.session_probe.held_back.value(), 1);
  world.store.Release();
  EXPECT_TRUE(greedy.ReadThrough(200));
  EXPECT_TRUE(other.ReadThrough(3));
  EXPECT_TRUE(Eventually([&] { return world.Settles(); }));
}

TEST(Streams, AStoreThatFailsIsTriedAgain) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  world.store.FailNextCommits(2, FailAt::kBefore);
  world.store.FailNextCommits(2, FailAt::kAfter);
  agent.Send(BatchFrame(FaultsFrom(1, 10)));
  ASSERT_TRUE(agent.ReadThrough(10));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, UpTo(10));
}

TEST(Streams, ManyRobotsOnFewQueues) {
  constexpr int kRobots = 24;
  constexpr model::Seq kMessages = 64;
  RelayWorld world({.session = {}, .journal = {}, .queues = 3});
  std::vector<std::unique_ptr<TestAgent>> agents;
  for (int i = 0; i < kRobots; ++i) {
    agents.push_back(std::make_unique<TestAgent>(world.Channel(RuriOf(i))));
    ASSERT_TRUE(agents.back()->Connect(SessionOf(1)));
  }
  // Each message a frame of its own, so that commits wake streams while these are busy.
  for (model::Seq seq = 1; seq <= kMessages; ++seq) {
    for (const auto& agent : agents) ASSERT_TRUE(agent->Send(BatchFrame(FaultsFrom(seq, 1))));
  }
  for (int i = 0; i < kRobots; ++i) {
    agents[static_cast<std::size_t>(i)]->HalfClose();
    const grpc::Status status = agents[static_cast<std::size_t>(i)]->End();
    ASSERT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(world.database.Log(RuriOf(i), SessionOf(1)).stored, UpTo(kMessages));
  }
  EXPECT_TRUE(world.Settles());
  EXPECT_EQ(world.Counts().stored, kRobots * kMessages);
  EXPECT_GT(world.relay_probe.wakes_total.value(), 0);
}

}  // namespace
}  // namespace uplink::testing
