// On a gateway's connection a stream that is held back costs its window, and its neighbours
// nothing.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/component/front/front_world.h"

namespace uplink::testing {
namespace {

/// The window of a stream, as it is agreed on without a word.
constexpr std::size_t kWindowBytes = 65'535;
constexpr std::uint32_t kNeighbours = 99;
constexpr std::size_t kBatch = 8;
/// What a robot may have stored at once, and per second then: more holds its stream back.
constexpr std::uint64_t kBurst = 4 * kBatch;
constexpr std::uint64_t kRate = 1;
/// A robot says so much more than its window holds.
constexpr std::size_t kWindowsSaid = 3;

/// Faults that a robot wants to send on its stream, from the first on.
class FaultFlood final {
 public:
  FaultFlood() {
    for (; bytes_.size() < kWindowsSaid * kWindowBytes; last_ += kBatch) {
      bytes_ += FaultsMessage(last_ + 1, kBatch);
    }
  }
  [[nodiscard]] std::string_view bytes() const { return bytes_; }
  [[nodiscard]] model::Seq last() const { return last_; }
  /// Bytes of so many faults, and of the batch that one more is in.
  [[nodiscard]] static std::size_t BytesOf(std::size_t faults) {
    return (faults / kBatch + 1) * FaultsMessage(1'000'000, kBatch).size();
  }

 private:
  std::string bytes_;
  model::Seq last_ = 0;
};

class GatewayFlow : public ::testing::Test {
 protected:
  GatewayFlow() {
    world_.allowances.Set({.flow = {.records = {.rate = kRate, .burst = kBurst}, .bytes = {}}});
  }
  void SetUp() override { ASSERT_TRUE(gateway_.Begin()); }

  /// The stream of the robot with this number.
  static std::uint32_t StreamOf(std::uint32_t robot) { return 2 * robot + 1; }
  void Open(std::uint32_t robot) {
    const std::uint32_t stream = StreamOf(robot);
    const std::string hello = HelloMessage(1, RuriOf(static_cast<int>(robot)));
    gateway_.Send(OpenRelay(stream));
    ASSERT_EQ(gateway_.SendData(stream, hello), hello.size());
    ASSERT_TRUE(gateway_.ReadUntil([&] { return !FramesOf(gateway_.At(stream)).empty(); }));
    ASSERT_TRUE(FramesOf(gateway_.At(stream)).front().has_welcome());
  }
  /// Says as much for the robot as the windows take now.
  void Say(std::uint32_t robot) {
    const std::uint32_t stream = StreamOf(robot);
    std::size_t& sent = sent_[robot];
    const std::string_view left = flood_.bytes().substr(sent);
    sent += gateway_.SendData(stream, left.substr(0, gateway_.WindowOf(stream)));
  }
  /// Says for all of them, until each is held back and the connection takes more, and not theirs.
  [[nodiscard]] bool FillWindows(const std::vector<std::uint32_t>& robots) {
    return Eventually([&] {
      for (const std::uint32_t robot : robots) Say(robot);
      if (!gateway_.Sync()) return false;
      return world_.session_probe.held_back.value() == static_cast<std::int64_t>(robots.size()) &&
             std::all_of(robots.begin(), robots.end(), [this](std::uint32_t robot) {
               return sent_[robot] >= kWindowBytes - kHelloBytes &&
                      gateway_.WindowOf(StreamOf(robot)) == 0;
             });
    });
  }
  /// A stream that is held back has used up its window.
  void ExpectHeldBack(std::uint32_t robot) {
    EXPECT_EQ(gateway_.WindowOf(StreamOf(robot)), 0U);
    EXPECT_FALSE(gateway_.At(StreamOf(robot)).over());
    // It gets a message per second, and no test lasts as long as as many again.
    EXPECT_LE(sent_[robot], kWindowBytes + FaultFlood::BytesOf(2 * kBurst));
  }
  [[nodiscard]] model::Seq AckedOn(std::uint32_t robot) const {
    return LastAck(gateway_.At(StreamOf(robot))).through_seq();
  }

  static constexpr std::size_t kHelloBytes = 256;
  RelayWorld world_{{.session = {.ack_interval = milliseconds(20)}}};
  RawHttp2 gateway_{ClientOf(world_, GatewayKeys(world_))};
  const FaultFlood flood_;
  std::map<std::uint32_t, std::size_t> sent_;
};

TEST_F(GatewayFlow, OneStreamThatIsHeldBackStopsNoneOfNinetyNine) {
  constexpr std::uint32_t kHeld = 0;
  ASSERT_NO_FATAL_FAILURE(Open(kHeld));
  ASSERT_TRUE(FillWindows({kHeld}));
  ExpectHeldBack(kHeld);
  for (std::uint32_t robot = 1; robot <= kNeighbours; ++robot) {
    ASSERT_NO_FATAL_FAILURE(Open(robot));
    const std::string batch = FaultsMessage(1, kBatch);
    ASSERT_EQ(gateway_.SendData(StreamOf(robot), batch), batch.size());
  }
  EXPECT_TRUE(gateway_.ReadUntil([&] {
    for (std::uint32_t robot = 1; robot <= kNeighbours; ++robot) {
      if (AckedOn(robot) != kBatch) return false;
    }
    return true;
  }));
  EXPECT_EQ(world_.session_probe.held_back.value(), 1);
  EXPECT_LE(AckedOn(kHeld), 2 * kBurst);
  ExpectHeldBack(kHeld);

  world_.allowances.Set({});
  EXPECT_EQ(gateway_.SendData(StreamOf(kHeld), flood_.bytes().substr(sent_[kHeld])),
            flood_.bytes().size() - sent_[kHeld]);
  EXPECT_TRUE(gateway_.ReadUntil([&] { return AckedOn(kHeld) == flood_.last(); }))
      << "and nothing of it is lost";
}

TEST_F(GatewayFlow, NinetyNineStreamsThatAreHeldBackStopNotTheOneBesideThem) {
  constexpr std::uint32_t kFree = kNeighbours + 1;
  std::vector<std::uint32_t> held;
  for (std::uint32_t robot = 1; robot <= kNeighbours; ++robot) {
    ASSERT_NO_FATAL_FAILURE(Open(robot));
    held.push_back(robot);
  }
  ASSERT_TRUE(FillWindows(held));
  ASSERT_NO_FATAL_FAILURE(Open(kFree));
  model::Seq seq = 0;
  for (std::uint64_t batch = 0; batch < kBurst / kBatch; ++batch, seq += kBatch) {
    const std::string faults = FaultsMessage(seq + 1, kBatch);
    ASSERT_EQ(gateway_.SendData(StreamOf(kFree), faults), faults.size());
    ASSERT_TRUE(gateway_.ReadUntil([&] { return AckedOn(kFree) == seq + kBatch; }));
  }
  for (const std::uint32_t robot : held) ExpectHeldBack(robot);
}

}  // namespace
}  // namespace uplink::testing
