// Two streams of one robot, and peers that do not read.
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

/// Bytes that the server may send to an agent that does not read.
constexpr int kSmallWindow = 512;

/// A world whose Welcome alone does not fit such a window.
RelayWorld::Options LongWelcome() {
  return {.session = {.server_version = std::string(std::size_t{32} * 1024, 'v')}};
}

std::shared_ptr<grpc::Channel> NarrowChannel(const RelayWorld& world) {
  ChannelSpec spec = world.SpecFor(RuriOf(1));
  spec.lookahead_bytes = kSmallWindow;
  return MakeChannel(spec);
}

/// Hello and a message, with nothing read: returns when the message was taken, so that the Welcome
/// is under way and cannot end.
void ConnectDeaf(RelayWorld& world, TestAgent& agent) {
  agent.Send(HelloFrame(SessionOf(1)));
  agent.Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(Eventually([&] { return world.Counts().received == 1; }));
}

TEST(Takeover, TheOlderStreamIsAborted) {
  RelayWorld world;
  TestAgent older(world.Channel(RuriOf(1)));
  ASSERT_TRUE(older.Connect(SessionOf(1)));
  older.Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(older.ReadThrough(1));

  TestAgent newer(world.Channel(RuriOf(1)));
  const auto welcome = newer.Connect(SessionOf(1), 1, 1);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->committed_seq(), 1U);
  const grpc::Status status = older.End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(status.error_message(), "superseded");
  EXPECT_EQ(world.session_probe.takeovers_total.value(), 1);

  newer.Send(BatchFrame({{2, FaultPayload("b")}}));
  EXPECT_TRUE(newer.ReadThrough(2));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, (std::vector<model::Seq>{1, 2}));
}

TEST(Takeover, WithinOneConnection) {
  RelayWorld world;
  const auto channel = world.Channel(RuriOf(1));
  TestAgent older(channel);
  ASSERT_TRUE(older.Connect(SessionOf(1)));
  TestAgent newer(channel);
  ASSERT_TRUE(newer.Connect(SessionOf(2)));
  EXPECT_EQ(older.End().error_code(), grpc::StatusCode::ABORTED);
}

TEST(Takeover, WhileTheStoreBlocks) {
  RelayWorld world;
  TestAgent older(world.Channel(RuriOf(1)));
  ASSERT_TRUE(older.Connect(SessionOf(1)));
  world.store.Block();
  older.Send(BatchFrame({{1, FaultPayload("a")}, {2, FaultPayload("b")}}));
  ASSERT_TRUE(world.store.WaitUntilBlocked(kPatience));

  TestAgent newer(world.Channel(RuriOf(1)));
  ASSERT_TRUE(newer.Connect(SessionOf(1)));
  EXPECT_EQ(older.End().error_code(), grpc::StatusCode::ABORTED);
  newer.Send(BatchFrame({{1, FaultPayload("a")}, {2, FaultPayload("b")}, {3, FaultPayload("c")}}));
  world.store.Release();
  ASSERT_TRUE(newer.ReadThrough(3));
  EXPECT_EQ(world.database.Log(RuriOf(1), SessionOf(1)).stored, (std::vector<model::Seq>{1, 2, 3}));
}

TEST(Takeover, OfAPeerThatDoesNotReadEndsItAfterASecond) {
  RelayWorld world(LongWelcome());
  TestAgent deaf(NarrowChannel(world));
  ASSERT_NO_FATAL_FAILURE(ConnectDeaf(world, deaf));

  // The new stream does not wait for the end of the old call.
  TestAgent newer(world.Channel(RuriOf(1)));
  ASSERT_TRUE(newer.Connect(SessionOf(2)));
  EXPECT_EQ(world.relay_probe.finish_timeouts_total.value(), 0);
  ASSERT_TRUE(Eventually([&] { return world.server().streams() == 1; }));
  EXPECT_EQ(world.relay_probe.finish_timeouts_total.value(), 1);
  EXPECT_EQ(deaf.End().error_code(), grpc::StatusCode::CANCELLED);
  newer.HalfClose();
  EXPECT_TRUE(newer.End().ok());
}

TEST(Deaf, AProtocolErrorEndsTheCallAfterASecond) {
  RelayWorld world(LongWelcome());
  TestAgent deaf(NarrowChannel(world));
  ASSERT_NO_FATAL_FAILURE(ConnectDeaf(world, deaf));
  deaf.Send(HelloFrame(SessionOf(1)));
  EXPECT_TRUE(Eventually([&] { return world.server().streams() == 0; }));
  EXPECT_EQ(world.relay_probe.finish_timeouts_total.value(), 1);
}

TEST(Deaf, ADrainEndsTheCall) {
  RelayWorld world(LongWelcome());
  TestAgent deaf(NarrowChannel(world));
  ASSERT_NO_FATAL_FAILURE(ConnectDeaf(world, deaf));
  world.server().Drain(milliseconds(100));
  EXPECT_TRUE(world.server().WaitForStreams(kPatience));
  EXPECT_TRUE(world.Settles());
}

TEST(Deaf, APeerThatReadsLateGetsEverything) {
  RelayWorld world;
  TestAgent deaf(NarrowChannel(world));
  ASSERT_TRUE(deaf.Connect(SessionOf(1)));
  constexpr model::Seq kMessages = 600;
  for (model::Seq seq = 1; seq <= kMessages; seq += 2) {
    ASSERT_TRUE(deaf.Send(BatchFrame({{seq, "rubbish"}, {seq + 1, FaultPayload("f")}})));
  }
  ASSERT_TRUE(Eventually([&] { return world.Counts().received == kMessages; }));
  ASSERT_TRUE(deaf.ReadThrough(kMessages));
  EXPECT_EQ(deaf.rejects().size(), kMessages / 2);
  EXPECT_EQ(world.relay_probe.finish_timeouts_total.value(), 0);
}

TEST(Deaf, AFloodOfRubbishIsHeldBackAndAnsweredWhole) {
  // More than is taken in a second, and more Rejects than may wait for the agent.
  RelayWorld world;
  TestAgent deaf(NarrowChannel(world));
  ASSERT_TRUE(deaf.Connect(SessionOf(1)));
  constexpr model::Seq kMessages = 4000;
  std::jthread sender([&deaf] {
    for (model::Seq seq = 1; seq <= kMessages; seq += 200) {
      v1::RelayRequest frame;
      for (model::Seq i = seq; i < seq + 200; ++i) frame.mutable_batch()->add_uplinks()->set_seq(i);
      if (!deaf.Send(frame)) return;
    }
  });
  ASSERT_TRUE(Eventually([&] { return world.session_probe.held_back.value() == 1; }));
  EXPECT_LT(world.Counts().received, kMessages);
  ASSERT_TRUE(deaf.ReadThrough(kMessages))
      << deaf.frames().size() << " frames, " << world.Counts().received << " received, "
      << deaf.frames().back().ShortDebugString();
  EXPECT_EQ(deaf.rejects().size(), kMessages);
  EXPECT_TRUE(Eventually([&] { return world.session_probe.held_back.value() == 0; }));
}

}  // namespace
}  // namespace uplink::testing
