// A gateway whose library answers what it gets, as grpc-go does: by a PING that measures the
// bandwidth, and by the connection's window.
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "server/front/http2/frame_rates.h"
#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

using transport::TurnedAway;

constexpr std::uint32_t kRobots = 200;
/// No DATA frame of this test is larger.
constexpr std::uint32_t kDataBytesMax = 256;

class GatewayPings : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(gateway_.Begin()); }

  static std::uint32_t StreamOf(std::uint32_t robot) { return 2 * robot + 1; }
  [[nodiscard]] std::size_t DataFrames() const {
    std::size_t frames = 0;
    for (const auto& [id, stream] : gateway_.streams()) frames += stream.data_frames;
    return frames;
  }
  /// Answers each DATA frame that came since the last time; false if the connection ends.
  bool Answer() {
    const std::size_t frames = DataFrames();
    const std::size_t unanswered = frames - answered_;
    answered_ = frames;
    return gateway_.Send(
        http2::Times(unanswered, http2::WindowUpdate(0, kDataBytesMax) + http2::Ping()));
  }
  void Open() {
    for (std::uint32_t robot = 0; robot < kRobots; ++robot) {
      const std::string hello = HelloMessage(1, RuriOf(static_cast<int>(robot)));
      gateway_.Send(OpenRelay(StreamOf(robot)));
      ASSERT_EQ(gateway_.SendData(StreamOf(robot), hello), hello.size());
    }
    ASSERT_TRUE(ReadFromAll([](const RawStream& stream) { return stream.data_frames > 0; }));
    ASSERT_TRUE(Answer());
  }
  /// Reads until the condition holds for the stream of each robot, one after the other.
  template <typename Condition>
  [[nodiscard]] bool ReadFromAll(const Condition& condition) {
    std::uint32_t robot = 0;
    return gateway_.ReadUntil([&] {
      while (robot < kRobots && condition(gateway_.At(StreamOf(robot)))) ++robot;
      return robot == kRobots;
    });
  }
  /// An event of each robot, and its Ack.
  void Round(model::Seq seq) {
    for (std::uint32_t robot = 0; robot < kRobots; ++robot) {
      const std::string event = FaultsMessage(seq, 1);
      ASSERT_EQ(gateway_.SendData(StreamOf(robot), event), event.size()) << "round " << seq;
    }
    ASSERT_TRUE(ReadFromAll([seq](const RawStream& stream) {
      return LastAck(stream).through_seq() == seq;
    })) << "round "
        << seq;
    ASSERT_TRUE(Answer()) << "round " << seq;
  }

  RelayWorld world_{{.session = {.ack_interval = milliseconds(20)}}};
  RawHttp2 gateway_{ClientOf(world_, GatewayKeys(world_))};
  std::size_t answered_ = 0;
};

TEST_F(GatewayPings, AfterEachDataEndNothing) {
  constexpr model::Seq kRounds = 30;
  ASSERT_NO_FATAL_FAILURE(Open());
  for (model::Seq seq = 1; seq <= kRounds; ++seq) ASSERT_NO_FATAL_FAILURE(Round(seq));
  EXPECT_GE(answered_, kRounds * kRobots);
  EXPECT_TRUE(gateway_.ReadUntil([this] { return gateway_.pongs() == answered_; }))
      << gateway_.pongs() << " of " << answered_;
  EXPECT_TRUE(gateway_.goaways().empty());
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kPings), 0);
}

TEST_F(GatewayPings, BeyondWhatWasSentEndTheConnection) {
  ASSERT_NO_FATAL_FAILURE(Open());
  ASSERT_TRUE(gateway_.ReadUntil([this] { return gateway_.pongs() == answered_; }));
  // As many again for the headers of the answers.
  gateway_.Send(http2::Times(kRobots, http2::Ping()));
  ASSERT_TRUE(gateway_.ReadUntil([this] { return gateway_.pongs() == answered_ + kRobots; }));
  // More than may be left over, whatever is sent meanwhile.
  static_cast<void>(gateway_.Send(http2::Times(2 * front::kForSentMax, http2::Ping())));
  EXPECT_TRUE(gateway_.ReadUntilEnd());
  EXPECT_EQ(gateway_.goaway_code(), http2::kEnhanceYourCalm);
  EXPECT_EQ(gateway_.goaway_text(), "too_many_pings");
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kPings), 1);
}

}  // namespace
}  // namespace uplink::testing
