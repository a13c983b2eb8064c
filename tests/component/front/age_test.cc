// How a connection ends for its age.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

/// Above every stream's number: nothing is refused yet.
constexpr std::uint32_t kNoStreamYet = 0x7FFFFFFF;

TEST(Age, AConnectionIsToldItsStreamSettlesAndThenItIsOver) {
  RelayWorld world({.session = {}, .journal = {}, .connection_age_max = milliseconds(300)});
  RawHttp2 client(ClientOf(world, RobotKeys(world, 1)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 3)));
  ASSERT_TRUE(client.ReadUntilOver(1));
  const auto frames = FramesOf(client.At(1));
  EXPECT_EQ(std::count_if(frames.begin(), frames.end(),
                          [](const v1::RelayResponse& frame) { return frame.has_drain(); }),
            1);
  EXPECT_EQ(LastAck(client.At(1)).through_seq(), 3U) << "what was taken is settled";
  EXPECT_EQ(StatusOf(client.At(1)), "14");
  EXPECT_TRUE(client.ReadUntilEnd());
  EXPECT_EQ(client.end(), RawTcp::End::kClosed);
  ASSERT_EQ(client.goaways().size(), 2U);
  EXPECT_EQ(client.goaways().front().last_stream, kNoStreamYet);
  EXPECT_EQ(client.goaways().back().last_stream, 1U);
  for (const auto& goaway : client.goaways()) EXPECT_EQ(goaway.code, http2::kNoError);
}

}  // namespace
}  // namespace uplink::testing
