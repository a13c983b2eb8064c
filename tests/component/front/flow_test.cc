// What bounds the memory of a stream, and what a stream that is held back costs others.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

/// The window of a stream, as it is agreed on without a word.
constexpr std::size_t kWindowBytes = 65'535;

/// What a stream may cost before anybody knows what it is for.
TEST(Flow, BeforeAHelloNothingLargerIsWaitedFor) {
  constexpr std::uint32_t kHelloMax = 16 * 1024;
  RelayWorld world;
  RawHttp2 client(ClientOf(world, RobotKeys(world, 1)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, Prefix(kHelloMax)));
  client.Send(OpenRelay(3) + http2::Data(3, Prefix(kHelloMax + 1)));
  ASSERT_TRUE(client.ReadUntilOver(3));
  EXPECT_EQ(StatusOf(client.At(3)), "3");
  EXPECT_THAT(client.At(3).Trailer("grpc-message"),
              HasSubstr("a hello or goodbye of more than 16 KiB"));
  EXPECT_FALSE(client.At(1).over());
  EXPECT_EQ(world.session_probe.protocol_errors_total.value(), 1);
}

/// nghttp2 tells of a window once half of it was given back, so that a message about as large as
/// the window may find less than the whole of it.
TEST(Flow, MessagesAboutAsLargeAsTheWindowComeThroughWhateverCameBefore) {
  RelayWorld world;
  int robot = 10;
  for (const std::size_t before : {0U, 16'000U, 30'000U, 32'600U}) {
    for (const std::size_t bytes : {32'700U, 40'000U, 65'000U, 65'600U}) {
      RawHttp2 client(ClientOf(world, RobotKeys(world, ++robot)));
      ASSERT_TRUE(client.Begin());
      client.Send(OpenRelay(1));
      std::string all = HelloMessage(1);
      for (const auto& [seq, size] : {std::pair{1U, before}, std::pair{2U, bytes}}) {
        all += WithPrefix(BatchFrame({{seq, std::string(size, 'x')}}).SerializeAsString());
      }
      ASSERT_EQ(client.SendData(1, all), all.size()) << before << " bytes, then " << bytes;
      EXPECT_TRUE(client.ReadUntil([&] { return LastAck(client.At(1)).through_seq() == 2; }));
    }
  }
}

std::string LiveMessage(model::Seq seq) {
  return WithPrefix(BatchFrame({{seq, MotionPayload()}}).SerializeAsString());
}

TEST(Flow, AStreamThatIsHeldBackStopsAtItsWindowWhileOtherRobotsFlowOn) {
  constexpr std::size_t kInFlightMax = 16;
  RelayWorld world(
      {.session = {.in_flight_uplinks_max = kInFlightMax, .ack_interval = milliseconds(20)}});
  RawHttp2 greedy(ClientOf(world, RobotKeys(world, 1)));
  RawHttp2 other(ClientOf(world, RobotKeys(world, 2)));
  for (RawHttp2* one : {&greedy, &other}) {
    ASSERT_TRUE(one->Begin());
    one->Send(OpenRelay(1));
    EXPECT_GT(one->SendData(1, HelloMessage(1)), 0U);
    ASSERT_TRUE(one->ReadUntil([&] { return !one->At(1).data.empty(); }));
  }
  world.store.Block();
  std::string all;
  model::Seq last = 0;
  for (; all.size() < 3 * kWindowBytes; last += 8) all += FaultsMessage(last + 1, 8);
  const std::size_t sent = greedy.SendData(1, all, milliseconds(500));
  EXPECT_EQ(greedy.WindowOf(1), 0U);
  EXPECT_TRUE(Eventually([&] { return world.session_probe.held_back.value() == 1; }));
  EXPECT_EQ(world.Counts().received, kInFlightMax);
  // Little was taken of it: all but these two messages is unread.
  EXPECT_LE(sent, kWindowBytes + 2 * FaultsMessage(1, 8).size());

  EXPECT_EQ(other.SendData(1, LiveMessage(1)), LiveMessage(1).size());
  EXPECT_TRUE(other.ReadUntil([&] { return LastAck(other.At(1)).judged_seq() == 1; }));
  EXPECT_EQ(world.session_probe.held_back.value(), 1);

  world.store.Release();
  EXPECT_EQ(greedy.SendData(1, std::string_view(all).substr(sent)), all.size() - sent);
  EXPECT_TRUE(greedy.ReadUntil([&] { return LastAck(greedy.At(1)).through_seq() == last; }));
  EXPECT_TRUE(Eventually([&] { return world.session_probe.held_back.value() == 0; }));
}

TEST(Flow, AStreamThatSendsPastItsWindowIsReset) {
  RelayWorld world({.session = {.in_flight_uplinks_max = 16}});
  RawHttp2 client(ClientOf(world, RobotKeys(world, 1)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1));
  EXPECT_GT(client.SendData(1, HelloMessage(1)), 0U);
  ASSERT_TRUE(client.ReadUntil([&] { return !client.At(1).data.empty(); }));
  world.store.Block();
  std::string all;
  for (model::Seq seq = 1; all.size() < 2 * kWindowBytes; seq += 8) all += FaultsMessage(seq, 8);
  EXPECT_LT(client.SendData(1, all, milliseconds(200)), all.size());
  ASSERT_EQ(client.WindowOf(1), 0U);
  client.Send(http2::Data(1, "x"));
  ASSERT_TRUE(client.ReadUntilOver(1));
  EXPECT_EQ(client.At(1).reset, http2::kFlowControlError);
  EXPECT_TRUE(Eventually([&] { return world.server().streams() == 0; }));
  EXPECT_TRUE(client.Sync()) << "the connection goes on";
}

/// Together they have more unread than the connection's window: it is given back as bytes arrive.
TEST(Flow, AHundredStreamsThatStandStillHoldNoneOfTheirConnectionUp) {
  constexpr std::uint32_t kStill = 99;
  RelayWorld world;
  RawHttp2 gateway(ClientOf(world, GatewayKeys(world)));
  ASSERT_TRUE(gateway.Begin());
  // As much as may come before a Hello, and below half a window: nothing of it is given back before
  // the message is whole.
  const std::string half = Prefix(16'000) + std::string(15'000, 'x');
  for (std::uint32_t i = 0; i < kStill; ++i) {
    gateway.Send(OpenRelay(2 * i + 1));
    ASSERT_EQ(gateway.SendData(2 * i + 1, half), half.size());
    EXPECT_EQ(gateway.At(2 * i + 1).window_given, 0U);
  }
  constexpr std::uint32_t kNext = 2 * kStill + 1;
  gateway.Send(OpenRelay(kNext));
  const std::string whole = HelloMessage(1, RuriOf(1));
  EXPECT_EQ(gateway.SendData(kNext, whole), whole.size());
  EXPECT_TRUE(gateway.ReadUntil([&] { return !gateway.At(kNext).data.empty(); }));
  EXPECT_FALSE(gateway.At(kNext).over());
  EXPECT_FALSE(gateway.At(1).over());
}

/// Little memory, so that unfinished frames have what one of the largest takes, and many threads.
RelayWorld::Options WithRoomForOneFrame() {
  return {.session = {.frame_bytes_max = 200'000},
          .journal = {},
          .queues = 8,
          .memory_bytes_max = std::size_t{1024} * 1024};
}

/// A stream with a frame that is not whole. Two of them may have room, three never.
bool SendsMostOfAFrame(RawHttp2& robot) {
  const std::string most = HelloMessage(1) + Prefix(200'000) + std::string(199'000, 'x');
  if (!robot.Begin()) return false;
  robot.Send(OpenRelay(1));
  return robot.SendData(1, most) == most.size() && robot.Sync();
}

TEST(Flow, AFrameOfTheLargestSizeComesThroughWhereverTheMemoryIsLittle) {
  RelayWorld world(WithRoomForOneFrame());
  RawHttp2 client(ClientOf(world, RobotKeys(world, 1)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1));
  std::string frame = BatchFrame({{1, std::string(199'900, 'x')}}).SerializeAsString();
  frame = BatchFrame({{1, std::string(199'900 + 200'000 - frame.size(), 'x')}}).SerializeAsString();
  ASSERT_EQ(frame.size(), world.options.session.frame_bytes_max);
  const std::string bytes = HelloMessage(1) + WithPrefix(frame);
  EXPECT_EQ(client.SendData(1, bytes), bytes.size());
  EXPECT_TRUE(client.ReadUntil([&] { return LastAck(client.At(1)).through_seq() == 1; }));
  EXPECT_EQ(world.relay_probe.unfinished_bytes.value(), 0);
  EXPECT_EQ(world.relay_probe.unfinished_ends_total.value(), 0);
}

TEST(Flow, TheSlowestUnfinishedFrameOfAllThreadsEndsWhereTheirMemoryIsUsedUp) {
  RelayWorld world(WithRoomForOneFrame());
  RawHttp2 slow(ClientOf(world, RobotKeys(world, 1)));
  RawHttp2 between(ClientOf(world, RobotKeys(world, 2)));
  RawHttp2 fast(ClientOf(world, RobotKeys(world, 3)));
  ASSERT_TRUE(SendsMostOfAFrame(slow));
  EXPECT_FALSE(slow.At(1).over()) << "the memory does for one";
  ASSERT_TRUE(SendsMostOfAFrame(between));
  ASSERT_TRUE(SendsMostOfAFrame(fast));
  ASSERT_TRUE(slow.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(slow.At(1)), "8");
  EXPECT_THAT(slow.At(1).Trailer("grpc-message"), HasSubstr("unfinished frames"));
  EXPECT_GE(world.relay_probe.unfinished_ends_total.value(), 1);
  ASSERT_TRUE(fast.Sync());
  EXPECT_FALSE(fast.At(1).over());
  EXPECT_GE(world.relay_probe.unfinished_bytes.value(), std::int64_t{199'000});
}

/// It always has a message that is not whole, each time another.
TEST(Flow, ABusyStreamIsNotTakenForTheSlowest) {
  RelayWorld world(WithRoomForOneFrame());
  RawHttp2 busy(ClientOf(world, RobotKeys(world, 1)));
  ASSERT_TRUE(busy.Begin());
  busy.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 1).substr(0, 10)));
  ASSERT_TRUE(busy.ReadUntil([&] { return !FramesOf(busy.At(1)).empty(); }));
  std::vector<std::unique_ptr<RawHttp2>> slow;
  for (model::Seq seq = 1; seq <= 3; ++seq) {
    slow.push_back(
        std::make_unique<RawHttp2>(ClientOf(world, RobotKeys(world, 10 + static_cast<int>(seq)))));
    ASSERT_TRUE(SendsMostOfAFrame(*slow.back()));
    busy.Send(
        http2::Data(1, FaultsMessage(seq, 1).substr(10) + FaultsMessage(seq + 1, 1).substr(0, 10)));
    ASSERT_TRUE(busy.ReadUntil([&] { return LastAck(busy.At(1)).through_seq() == seq; })) << seq;
  }
  ASSERT_TRUE(slow.front()->ReadUntilOver(1));
  EXPECT_EQ(StatusOf(slow.front()->At(1)), "8");
  ASSERT_TRUE(busy.Sync());
  EXPECT_FALSE(busy.At(1).over());
}

}  // namespace
}  // namespace uplink::testing
