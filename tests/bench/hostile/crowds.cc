#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/hostile/attack.h"
#include "tests/support/attack_bytes.h"
#include "tests/support/http2_frames.h"
#include "tests/support/relay_bytes.h"
#include "tests/support/tcp_crowd.h"

namespace uplink::bench {
namespace {

namespace attack = testing::attack;
namespace http2 = testing::http2;
using testing::RawHttp2;
using testing::TcpCrowd;

/// As many as a robot's certificate may have.
constexpr std::size_t kConnectionsOfRobot = 4;
constexpr std::size_t kConnectionsOfOneKey = 700;
constexpr std::size_t kStreamsOfEach = 16;
constexpr std::size_t kHandshakesMax = 20'000;
constexpr std::size_t kHalfOpen = 600;
constexpr std::size_t kSlowHandshakes = 200;
constexpr std::size_t kSilent = 2'000;
constexpr std::size_t kMoreThanDescriptors = 1'000;
constexpr std::size_t kHalfFrameBytes = 20;
constexpr milliseconds kSecond{1'000};
constexpr milliseconds kLook{100};

using Connections = std::vector<std::unique_ptr<RawHttp2>>;

bool Never() { return false; }

/// Nothing is done until then, at most as long as the attack lasts.
void Wait(const AttackSite& site, milliseconds time) {
  static_cast<void>(testing::Eventually(Never, std::min(time, site.Left())));
}

Connections Connect(const AttackSite& site, std::size_t count) {
  Connections connections;
  while (connections.size() < count && !site.Over()) {
    connections.push_back(std::make_unique<RawHttp2>(site.Robot()));
  }
  return connections;
}

void HandshakeAndLeave(const AttackSite& site, const RawHttp2::Options& client) {
  RawHttp2::Options options = client;
  for (std::size_t i = 0; i < kHandshakesMax && !site.Over(); ++i) {
    options.patience = site.Left();
    const RawHttp2 passer_by(options);
  }
}

/// So many connections that say a word; who is sent away comes back.
void Crowd(const AttackSite& site, std::vector<std::string> sources, const std::string& word,
           std::size_t count) {
  TcpCrowd crowd(site.port, std::move(sources), word);
  crowd.Grow(count);
  while (!site.Over()) {
    Wait(site, kLook);
    crowd.Replace();
  }
}

std::vector<std::string> One() { return {std::string(kAttackerSource)}; }

}  // namespace

void SendHalfAFrame(const AttackSite& site) {
  const Connections connections = Connect(site, kConnectionsOfRobot);
  for (const auto& connection : connections) {
    if (connection->Begin()) connection->Send(testing::OpenRelay(1).substr(0, kHalfFrameBytes));
  }
  Wait(site, site.Left());
}

void TrickleFrames(const AttackSite& site) {
  const Connections connections = Connect(site, kConnectionsOfRobot);
  const std::string bytes = http2::Preface() + http2::Settings({}) + testing::OpenRelay(1);
  for (std::size_t at = 0; at < bytes.size() && !site.Over(); ++at) {
    for (const auto& connection : connections) connection->Send(bytes.substr(at, 1));
    Wait(site, kSecond);
  }
}

void SayNothingAsRobot(const AttackSite& site) {
  const Connections connections = Connect(site, kConnectionsOfRobot);
  Wait(site, site.Left());
}

void CrowdOfOneKey(const AttackSite& site) {
  Connections connections;
  while (connections.size() < kConnectionsOfOneKey && !site.Over()) {
    connections.push_back(std::make_unique<RawHttp2>(site.Robot()));
    if (connections.back()->Begin()) connections.back()->Send(attack::Opened(1, kStreamsOfEach));
  }
  Wait(site, site.Left());
}

void LeaveAsRobot(const AttackSite& site) { HandshakeAndLeave(site, site.Robot()); }

void LeaveAsNobody(const AttackSite& site) { HandshakeAndLeave(site, site.Nobody()); }

void LeaveHalfOpen(const AttackSite& site) {
  Crowd(site, One(), testing::TlsClientHello(), kHalfOpen);
}

void TrickleHandshakes(const AttackSite& site) {
  TcpCrowd crowd(site.port, One(), "");
  crowd.Grow(kSlowHandshakes);
  const std::string hello = testing::TlsClientHello();
  for (std::size_t at = 0; at < hello.size() && !site.Over(); ++at) {
    for (const auto& member : crowd.members()) {
      static_cast<void>(member->SendSome(hello.substr(at, 1)));
    }
    Wait(site, kSecond);
  }
}

void SayNothingFromOne(const AttackSite& site) { Crowd(site, One(), "", kSilent); }

void SayNothingFromFifty(const AttackSite& site) {
  Crowd(site, testing::LoopbackSources(kFirstOfManySources, kManySources), "", kSilent);
}

void TakeDescriptors(const AttackSite& site) { Crowd(site, One(), "", kMoreThanDescriptors); }

}  // namespace uplink::bench
