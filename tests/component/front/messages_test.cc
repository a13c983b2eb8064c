// Messages of a call, however DATA frames and windows cut them.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

class Messages : public ::testing::Test {
 protected:
  RelayWorld world_;
  RawHttp2 client_{ClientOf(world_, RobotKeys(world_, 1))};
};

TEST_F(Messages, MayBeCutAnywhere) {
  const std::string both = HelloMessage(1) + FaultsMessage(1, 1);
  for (std::size_t cut = 1; cut < both.size(); ++cut) {
    // A robot of its own for each cut: one that came so often would have to wait.
    RawHttp2 robot(ClientOf(world_, RobotKeys(world_, 100 + static_cast<int>(cut))));
    ASSERT_TRUE(robot.Begin());
    robot.Send(OpenRelay(1) + http2::Data(1, both.substr(0, cut)) +
               http2::Data(1, both.substr(cut), http2::kEndStream));
    ASSERT_TRUE(robot.ReadUntilOver(1)) << "cut at " << cut;
    EXPECT_EQ(StatusOf(robot.At(1)), "0") << "cut at " << cut;
    EXPECT_EQ(LastAck(robot.At(1)).through_seq(), 1U) << "cut at " << cut;
  }
}

TEST_F(Messages, ThoseThatBreakTheRulesOfGrpcAreInternal) {
  const std::string hello = HelloMessage(1);
  const std::string last = http2::Data(1, "", http2::kEndStream);
  const std::pair<std::string, std::string> kinds[] = {
      {http2::Data(1, hello.substr(0, hello.size() - 1)) + last, "within a message"},
      {http2::Data(1, hello + Prefix(7).substr(0, 4)) + last, "within a message"},
      {http2::Data(1, hello + Prefix(3, '\1') + "abc"), "flagged as compressed"},
      {http2::Data(1, Prefix(3, '\xFF') + "abc"), ""}};
  int robot = 10;
  for (const auto& [bytes, words] : kinds) {
    RawHttp2 client(ClientOf(world_, RobotKeys(world_, ++robot)));
    ASSERT_TRUE(client.Begin());
    client.Send(OpenRelay(1) + bytes);
    ASSERT_TRUE(client.ReadUntilOver(1)) << words;
    EXPECT_EQ(StatusOf(client.At(1)), "13") << words;
    EXPECT_THAT(client.At(1).Trailer("grpc-message"), HasSubstr(words));
  }
}

TEST_F(Messages, PaddingIsGivenBackToTheWindow) {
  ASSERT_TRUE(client_.Begin());
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
  // Each carries one byte of 257: with the padding kept, the window would not do for half of them.
  std::string bytes;
  for (model::Seq seq = 1; bytes.size() < 600; ++seq) bytes += FaultsMessage(seq, 1);
  for (const char byte : bytes) {
    const std::string payload = std::string(1, '\xFF') + byte + std::string(255, '\0');
    ASSERT_TRUE(client_.Send(http2::Frame(http2::kData, http2::kPadded, 1, payload)));
  }
  client_.Send(http2::Data(1, "", http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "0");
}

/// The client's window opens by one byte at first, then not at all, then wide.
TEST_F(Messages, AnswersLargerThanTheWindowWaitForIt) {
  ASSERT_TRUE(client_.Begin({{http2::kInitialWindowSize, 1}}));
  client_.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 2)));
  ASSERT_TRUE(client_.ReadUntil([&] { return !client_.At(1).data.empty(); }));
  client_.Send(http2::Settings({{http2::kInitialWindowSize, 0}}));
  ASSERT_TRUE(client_.Sync());
  EXPECT_EQ(client_.At(1).data.size(), 1U);
  ASSERT_TRUE(Eventually([&] { return world_.Counts().stored == 2; }));

  // 1 and -1 came to nothing: three bytes are three.
  client_.Send(http2::WindowUpdate(1, 4));
  ASSERT_TRUE(client_.ReadUntil([&] { return client_.At(1).data.size() == 4; }));
  client_.Send(http2::Settings({{http2::kInitialWindowSize, 100'000}}));
  ASSERT_TRUE(client_.ReadUntil([&] { return LastAck(client_.At(1)).through_seq() == 2; }));
  EXPECT_TRUE(FramesOf(client_.At(1)).front().has_welcome());
  client_.Send(http2::Data(1, FaultsMessage(3, 1), http2::kEndStream));
  ASSERT_TRUE(client_.ReadUntilOver(1));
  EXPECT_EQ(StatusOf(client_.At(1)), "0");
  EXPECT_EQ(LastAck(client_.At(1)).through_seq(), 3U);
}

}  // namespace
}  // namespace uplink::testing
