// The server's own handshake with its listener, which tells whether it still reads.
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/loop/client_hello.h"
#include "server/loop/event_loop.h"
#include "server/loop/handshake_probe.h"
#include "tests/component/front/front_world.h"
#include "tests/support/kept_lines.h"
#include "tests/support/raw_tcp.h"

namespace uplink::testing {
namespace {

/// So few that a test can take every place: 128 handshakes, and as many that wait.
constexpr std::size_t kDescriptors = 1024;
/// More than have a place and may wait.
constexpr int kSources = 300;
/// Less than a place that somebody keeps lasts.
constexpr std::chrono::seconds kAnsweredWithin{3};

class OwnProbe : public ::testing::Test {
 protected:
  OwnProbe() { loop_.Start(); }

  /// Asks the listener as the server does.
  bool Asks() {
    std::promise<bool> answered;
    loop_.Post([&] {
      loop::ProbeHandshake(loop_,
                           {.address = {"127.0.0.1", world_->server().port()},
                            .own_port = &world_->relay_probe.own_port},
                           kAnsweredWithin, [&](bool good) { answered.set_value(good); });
    });
    return answered.get_future().get();
  }
  static std::unique_ptr<RelayWorld> MakeWorld() {
    const DescriptorLimit limit(kDescriptors);
    return std::make_unique<RelayWorld>();
  }

  std::unique_ptr<RelayWorld> world_ = MakeWorld();
  log::Logger logger_{std::make_unique<NoLines>(), world_->clock, log::Format::kText,
                      log::Level::kError};
  loop::EventLoop loop_{logger_};
};

TEST_F(OwnProbe, IsAnsweredWhileSourcesWithoutNumberKeepEveryPlace) {
  const std::string hello = loop::MakeClientHello();
  std::vector<std::unique_ptr<RawTcp>> crowd;
  for (int i = 0; i < kSources; ++i) {
    crowd.push_back(std::make_unique<RawTcp>(
        world_->server().port(),
        "127.0." + std::to_string(1 + i / 250) + "." + std::to_string(1 + i % 250)));
    static_cast<void>(crowd.back()->SendSome(hello));
  }
  ASSERT_TRUE(
      Eventually([&] { return TurnedAwayFor(*world_, transport::TurnedAway::kCrowded) > 0; }));
  EXPECT_TRUE(Asks());
}

}  // namespace
}  // namespace uplink::testing
