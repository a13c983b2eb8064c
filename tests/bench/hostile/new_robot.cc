#include "tests/bench/hostile/new_robot.h"

#include <algorithm>

#include "tests/support/eventually.h"
#include "tests/support/raw_http2.h"
#include "tests/support/relay_bytes.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kBetweenTries{100};

bool GetsIn(const testing::RawHttp2::Options& options) {
  testing::RawHttp2 robot(options);
  if (!robot.Begin()) return false;
  const std::string said = testing::HelloMessage(1) + testing::FaultsMessage(1, 1);
  robot.Send(testing::OpenRelay(1) + testing::http2::Data(1, said));
  return robot.ReadUntil([&] { return testing::LastAck(robot.At(1)).through_seq() == 1; },
                         options.patience);
}

}  // namespace

std::optional<milliseconds> TimeToGetIn(const NewRobot& robot, const Clock& clock) {
  const SteadyTime began = clock.Steady();
  testing::RawHttp2::Options options;
  options.port = robot.port;
  options.server_ca = robot.server_ca;
  options.identity = robot.identity;
  options.source = kNewRobotSource;
  for (SteadyTime now = began; now < began + kGetsInWithin; now = clock.Steady()) {
    options.patience = std::chrono::ceil<milliseconds>(began + kGetsInWithin - now);
    if (GetsIn(options)) {
      const auto took = std::chrono::ceil<milliseconds>(clock.Steady() - began);
      if (took <= kGetsInWithin) return took;
    }
    static_cast<void>(testing::Eventually([] { return false; }, kBetweenTries));
  }
  return std::nullopt;
}

}  // namespace uplink::bench
