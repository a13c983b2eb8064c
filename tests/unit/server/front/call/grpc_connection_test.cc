// A connection of gRPC without a socket and TLS.
#include "server/front/call/grpc_connection.h"

#include <gtest/gtest.h>

#include "tests/fuzz/front_bench.h"
#include "tests/support/http2_frames.h"
#include "tests/support/relay_bytes.h"

namespace uplink::front {
namespace {

using fuzz::FrontBench;
using fuzz::FrontWire;
using transport::TurnedAway;
using namespace uplink::testing;  // NOLINT(google-build-using-namespace): what peers say

class GrpcConnectionTest : public ::testing::Test {
 protected:
  FrontWire& Connect(std::uint8_t robot) {
    FrontWire& wire = bench_.Connect(robot);
    wire.Receive(http2::Preface() + http2::Settings({}));
    return wire;
  }
  [[nodiscard]] std::int64_t TurnedAwayFor(TurnedAway cause) {
    return bench_.relay_probe().turned_away_total[static_cast<std::size_t>(cause)].value();
  }

  FrontBench bench_;
};

TEST_F(GrpcConnectionTest, APeerThatPingsTooOftenIsToldInTheWordsOfGrpc) {
  FrontWire& wire = Connect(1);
  wire.Receive(http2::Times(kStrikesMax + 1, http2::Ping()));
  EXPECT_TRUE(wire.answers().goaways().empty());
  wire.Receive(http2::Ping());
  ASSERT_FALSE(wire.answers().goaways().empty());
  EXPECT_EQ(wire.answers().goaways().front().text, "too_many_pings");
  EXPECT_EQ(TurnedAwayFor(TurnedAway::kPings), 1);
  EXPECT_EQ(TurnedAwayFor(TurnedAway::kProtocol), 0);
}

TEST_F(GrpcConnectionTest, ABrokenRuleIsCountedOnce) {
  FrontWire& wire = Connect(1);
  wire.Receive(http2::Data(0, "x"));
  EXPECT_FALSE(wire.open());
  EXPECT_EQ(TurnedAwayFor(TurnedAway::kProtocol), 1);
}

TEST_F(GrpcConnectionTest, ItEndsWithItsLastCallOnceItDrains) {
  FrontWire& wire = Connect(1);
  wire.Receive(OpenRelay(1));
  bench_.Drain(std::chrono::seconds(10));
  EXPECT_TRUE(wire.open());
  wire.Receive(http2::RstStream(1, http2::kCancel));
  EXPECT_FALSE(wire.open());
  EXPECT_EQ(wire.answers().goaways().back().code, 0U);
}

TEST_F(GrpcConnectionTest, ItEndsOnceItsPeerWasToldThatItMayNotCall) {
  FrontWire& wire = Connect(fuzz::kStranger);
  wire.Receive(OpenRelay(1) + http2::Data(1, "", http2::kEndStream));
  EXPECT_EQ(StatusOf(wire.answers().At(1)), "16");
  EXPECT_FALSE(wire.open());
}

}  // namespace
}  // namespace uplink::front
