// What a process sees whose configuration asks for TLS 1.3.
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "server/relay/environment.h"
#include "tests/support/relay_world.h"
#include "tests/support/tls_probe.h"

namespace uplink::testing {
namespace {

RelayWorld::Options OnGrpc() {
  RelayWorld::Options options;
  options.transport = config::Transport::kGrpc;
  return options;
}

class Tls13 : public ::testing::Test {
 protected:
  // Before gRPC is used for the first time in this process.
  static void SetUpTestSuite() { relay::ApplyTlsMinimum(config::TlsVersion::k13); }
};

TEST_F(Tls13, RefusesTls12) {
  RelayWorld world(OnGrpc());
  EXPECT_EQ(AgreedTlsVersion(world.server().port(), TLS1_2_VERSION), "");
  EXPECT_EQ(AgreedTlsVersion(world.server().port(), TLS1_3_VERSION), "TLSv1.3");
}

TEST_F(Tls13, ServesRobots) {
  RelayWorld world(OnGrpc());
  TestAgent agent(world.Channel(RuriOf(1)));
  ASSERT_TRUE(agent.Connect(SessionOf(1)));
  agent.Send(BatchFrame({{1, FaultPayload("hot")}}));
  EXPECT_TRUE(agent.ReadThrough(1));
}

}  // namespace
}  // namespace uplink::testing
