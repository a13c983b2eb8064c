// Frames at and past their limit, robots and streams at theirs.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/transport/gate.h"
#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t kFrameBytesMax = 64 * 1024;

/// A whole batch of one message in exactly `bytes` bytes; its content is rejected, its form is
/// good.
std::string FrameOf(std::size_t bytes) {
  const std::size_t overhead = BatchFrame({{1, std::string(bytes, 'x')}}).ByteSizeLong() - bytes;
  return BatchFrame({{1, std::string(bytes - overhead, 'x')}}).SerializeAsString();
}

TEST(Bounds, AFramePastItsLimitEndsTheStreamHoweverFar) {
  for (const std::size_t bytes : {std::size_t{kFrameBytesMax} + 1, std::size_t{8} * 1024 * 1024}) {
    RelayWorld world({.session = {.frame_bytes_max = kFrameBytesMax}});
    TestAgent agent(world.Channel(RuriOf(1)));
    EXPECT_TRUE(agent.Connect(SessionOf(1)));
    agent.SendBytes(FrameOf(bytes));
    const grpc::Status status = agent.End();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(status.error_message(), "frame 2: " + std::to_string(bytes) +
                                          " bytes, the limit is 65536 (limits.frame_bytes_max)");
    EXPECT_EQ(world.Counts().received, 0U);
    EXPECT_TRUE(Eventually([&] { return world.server().streams() == 0; }));
  }
}

TEST(Bounds, StreamsAreBounded) {
  RelayWorld world({.session = {}, .journal = {}, .streams_max = 2});
  TestAgent first(world.Channel(RuriOf(1)));
  auto second = std::make_unique<TestAgent>(world.Channel(RuriOf(2)));
  ASSERT_TRUE(first.Connect(SessionOf(1)));
  ASSERT_TRUE(second->Connect(SessionOf(2)));
  {
    TestAgent third(world.Channel(RuriOf(3)));
    const grpc::Status status = third.End();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(status.error_message(), HasSubstr("admits no more streams"));
    EXPECT_EQ(world.relay_probe.refused_full_total.value(), 1);
  }
  second.reset();
  ASSERT_TRUE(Eventually([&] { return world.server().streams() == 1; }));
  TestAgent third(world.Channel(RuriOf(3)));
  EXPECT_TRUE(third.Connect(SessionOf(3)));
}

TEST(Bounds, StreamsOfOneConnectionWaitForEachOther) {
  constexpr int streams_max = 100;
  RelayWorld world({.session = {}, .journal = {}, .gateway_streams_max = streams_max});
  // A gateway's: a robot's own certificate may have few.
  CertificateSpec spec;
  spec.units = {"gateway"};
  const auto channel = world.Channel(world.authority.Issue(spec));
  std::vector<std::unique_ptr<TestAgent>> agents;
  agents.reserve(static_cast<std::size_t>(streams_max));
  for (int i = 0; i < streams_max; ++i) {
    agents.push_back(std::make_unique<TestAgent>(channel));
  }
  const auto& streams = world.session_probe.streams_total;
  ASSERT_TRUE(Eventually([&] { return streams.value() == streams_max; }));
  {
    // Beginning the call waits for a place, in vain.
    TestAgent late(channel, {.patience = milliseconds(300)});
    EXPECT_EQ(late.End().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  }
  EXPECT_EQ(streams.value(), streams_max);
  agents.front()->Cancel();
  TestAgent next(channel);
  EXPECT_TRUE(Eventually([&] { return streams.value() == streams_max + 1; }));
}

TEST(Bounds, StreamsOfOneCertificateAreBounded) {
  RelayWorld world;
  const auto channel = world.Channel(RuriOf(1));
  std::vector<std::unique_ptr<TestAgent>> agents;
  agents.reserve(transport::kStreamsPerCertificateMax);
  for (std::size_t i = 0; i < transport::kStreamsPerCertificateMax; ++i) {
    agents.push_back(std::make_unique<TestAgent>(channel));
  }
  ASSERT_TRUE(Eventually([&] { return world.server().streams() == agents.size(); }));
  {
    TestAgent ninth(world.Channel(RuriOf(1)));
    const grpc::Status status = ninth.End();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(status.error_message(), HasSubstr("of this certificate: it has 8"));
  }
  EXPECT_EQ(world.relay_probe.refused_robot_total.value(), 1);
  EXPECT_EQ(world.relay_probe.refused_full_total.value(), 0) << "the server is not full";
  TestAgent other(world.Channel(RuriOf(2)));
  EXPECT_TRUE(other.Connect(SessionOf(2)));
}

}  // namespace
}  // namespace uplink::testing
