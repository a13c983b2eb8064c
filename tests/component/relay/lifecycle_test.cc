// Start, drain and stop of the listener.
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/relay_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

const config::ListenAddress kAnyPort{"127.0.0.1", 0};

TEST(Lifecycle, AnAddressThatIsNotOursIsNamed) {
  RelayWorld world;
  const auto started = world.StartAnother({"192.0.2.1", 7443}, world.ServerTexts());
  ASSERT_FALSE(started.ok());
  EXPECT_THAT(std::string(started.status().message()),
              HasSubstr("cannot listen on 192.0.2.1:7443: Cannot assign requested address"));
}

TEST(Lifecycle, AKeyOfAnotherCertificateIsNamed) {
  RelayWorld world;
  transport::PemTexts texts = world.ServerTexts();
  texts.key = world.authority.Issue(ServerSpec()).key;
  const auto started = world.StartAnother(kAnyPort, texts);
  ASSERT_FALSE(started.ok());
  EXPECT_EQ(started.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(started.status().message()),
              HasSubstr("the key: is not the key of the certificate"));
}

TEST(Lifecycle, PartsThatAreNoPemAreNamed) {
  RelayWorld world;
  const auto expect = [&](const transport::PemTexts& texts, const char* text) {
    const auto started = world.StartAnother(kAnyPort, texts);
    ASSERT_FALSE(started.ok());
    EXPECT_THAT(std::string(started.status().message()), HasSubstr(text));
  };
  const transport::PemTexts good = world.ServerTexts();
  expect({"", good.key, good.client_ca}, "the certificate: holds no PEM certificate");
  expect({good.certificate, "x", good.client_ca}, "the key: holds no PEM private key");
  expect({good.certificate, good.key, "x"}, "the client authority: holds no PEM certificate");
}

TEST(Lifecycle, AMissingFileIsNamed) {
  RelayWorld world;
  const auto started = world.StartAnother(
      kAnyPort,
      transport::PemFiles{"/no/such/server.crt", "/no/such/server.key", "/no/such/ca.crt"});
  ASSERT_FALSE(started.ok());
  EXPECT_EQ(
      std::string(started.status().message()),
      "/no/such/server.crt: cannot be read: No such file or directory; correct the path, or make "
      "the file");
}

TEST(Lifecycle, StartsAndStopsWithoutARobot) {
  RelayWorld world;
  world.server().Shutdown();
  world.server().Shutdown();
  EXPECT_EQ(world.server().streams(), 0U);
}

TEST(Lifecycle, WakingAStreamOfAStoppedServerDoesNothing) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  world.store.Block();
  agent.Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(world.store.WaitUntilBlocked(kPatience));
  world.StopServer();
  EXPECT_EQ(agent.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  world.store.Release();
  EXPECT_TRUE(world.Settles());
  EXPECT_EQ(world.Counts().stored, 1U);
}

TEST(Lifecycle, DrainTellsSettlesAndEndsUnavailable) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  world.store.Block();
  agent.Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(world.store.WaitUntilBlocked(kPatience));
  world.server().Drain(std::chrono::seconds(10));
  EXPECT_TRUE(world.server().draining());
  std::optional<v1::RelayResponse> frame = agent.Read();
  while (frame && !frame->has_drain()) frame = agent.Read();
  ASSERT_TRUE(frame);
  EXPECT_GT(frame->drain().grace_ms(), 5'000);
  EXPECT_LE(frame->drain().grace_ms(), 10'000);
  EXPECT_FALSE(world.server().WaitForStreams(milliseconds(1)));

  world.store.Release();
  const grpc::Status status = agent.End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(status.error_message(), "the server drains");
  ASSERT_TRUE(agent.frames().back().has_ack());
  EXPECT_EQ(agent.frames().back().ack().through_seq(), 1U);
  EXPECT_TRUE(world.server().WaitForStreams(kPatience));
}

TEST(Lifecycle, DrainRefusesNewStreams) {
  RelayWorld world;
  const auto channel = world.Channel(RuriOf(1));
  TestAgent first(channel);
  ASSERT_TRUE(first.Connect(SessionOf(1)));
  world.server().Drain(std::chrono::seconds(10));
  TestAgent second(world.Channel(RuriOf(2)));
  second.Send(HelloFrame(SessionOf(2)));
  const grpc::Status status = second.End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("refused")) << "the listener is closed first";
  EXPECT_EQ(first.End().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST(Lifecycle, DrainEndsAStreamThatCannotSettle) {
  RelayWorld world;
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  world.store.Block();
  agent.Send(BatchFrame({{1, FaultPayload("a")}}));
  ASSERT_TRUE(world.store.WaitUntilBlocked(kPatience));
  world.server().Drain(milliseconds(100));
  EXPECT_EQ(agent.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(world.server().WaitForStreams(kPatience));
}

}  // namespace
}  // namespace uplink::testing
