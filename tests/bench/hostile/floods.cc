#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "tests/bench/hostile/attack.h"
#include "tests/support/attack_bytes.h"
#include "tests/support/http2_frames.h"
#include "tests/support/relay_bytes.h"
#include "tests/support/relay_samples.h"

namespace uplink::bench {
namespace {

namespace attack = testing::attack;
namespace http2 = testing::http2;
using testing::RawHttp2;

/// Of an attack; a server that ends each has shown what it does.
constexpr int kConnectionsMax = 50;
constexpr std::uint32_t kAnnouncedBytes = 600'000'000;
constexpr std::size_t kAnnouncements = 8;
constexpr std::size_t kTrickleBytes = std::size_t{16} * 1024;
constexpr std::size_t kStreams = 10'000;
constexpr std::size_t kResets = 100'000;
constexpr std::size_t kFloodFrames = 200'000;
constexpr std::size_t kBombs = 1'000;
constexpr std::size_t kLongHeaders = 200;
constexpr std::size_t kLongHeaderBytes = 200'000;
constexpr std::size_t kContinuations = 10'000;
constexpr std::size_t kRejected = 100'000;
/// Of a flood: so much is made at a time.
constexpr std::size_t kAtOnce = 500;
constexpr std::size_t kSentAtOnce = std::size_t{64} * 1024;
constexpr std::uint32_t kLargestWindow = 0x7FFFFFFF;
constexpr milliseconds kGlance{1};
constexpr milliseconds kWindowWait{50};

bool Never() { return false; }

/// One connection after the other, as long as the attack lasts.
void OnConnections(const AttackSite& site, const std::function<void(RawHttp2&)>& act) {
  for (int i = 0; i < kConnectionsMax && !site.Over(); ++i) {
    RawHttp2 connection(site.Robot());
    if (connection.Begin()) act(connection);
  }
}

/// False once the connection or the attack is over. What the server says meanwhile is read.
bool Pour(const AttackSite& site, RawHttp2& connection, std::string_view flood) {
  while (!flood.empty()) {
    const std::string_view part = flood.substr(0, kSentAtOnce);
    if (site.Over() || !connection.Send(part)) return false;
    flood.remove_prefix(part.size());
    static_cast<void>(connection.ReadUntil(Never, kGlance));
  }
  return connection.open();
}

/// The connection stays as it is.
void Hold(const AttackSite& site, RawHttp2& connection) {
  static_cast<void>(connection.ReadUntilEnd(site.Left()));
}

/// Connections that each send `first`, and then the frame so many times.
void Repeat(const AttackSite& site, const std::string& first, std::string_view frame,
            std::size_t times) {
  const std::string some = http2::Times(std::min(kAtOnce, times), frame);
  OnConnections(site, [&](RawHttp2& connection) {
    bool goes_on = Pour(site, connection, first);
    for (std::size_t said = 0; goes_on && said < times; said += kAtOnce) {
      goes_on = Pour(site, connection, some);
    }
    Hold(site, connection);
  });
}

/// So much of each announced message as the windows allow; false once all streams are over.
bool TrickleOn(RawHttp2& connection, std::uint32_t first) {
  const std::string bytes(kTrickleBytes, 'x');
  bool goes_on = false;
  for (std::size_t i = 0; i < kAnnouncements; ++i) {
    const std::uint32_t stream = attack::After(first, i);
    if (connection.At(stream).over()) continue;
    goes_on = true;
    connection.SendData(stream, bytes, kWindowWait);
  }
  return goes_on && connection.open();
}

}  // namespace

void Announce(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    std::uint32_t first = 1;
    while (!site.Over() && connection.open()) {
      for (std::size_t i = 0; i < kAnnouncements; ++i) {
        connection.Send(attack::Announcement(attack::After(first, i), kAnnouncedBytes, 0));
      }
      while (!site.Over() && TrickleOn(connection, first)) {
      }
      first = attack::After(first, kAnnouncements);
    }
  });
}

void OpenStreams(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    Pour(site, connection, attack::Opened(1, kStreams));
    Hold(site, connection);
  });
}

void Reset(const AttackSite& site) {
  std::size_t left = kResets;
  OnConnections(site, [&](RawHttp2& connection) {
    std::uint32_t first = 1;
    while (left > 0) {
      const std::size_t some = std::min(left, kAtOnce);
      left -= some;
      if (!Pour(site, connection, attack::RapidResets(first, some))) return;
      first = attack::After(first, some);
    }
    Hold(site, connection);
  });
}

void BombHeaders(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    bool goes_on = Pour(site, connection, attack::HeaderBombFuse(1));
    for (std::size_t i = 1; goes_on && i <= kBombs; ++i) {
      goes_on = Pour(site, connection, attack::HeaderBomb(attack::After(1, i)));
    }
    Hold(site, connection);
  });
}

void LengthenHeaders(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    bool goes_on = true;
    for (std::size_t i = 0; goes_on && i < kLongHeaders; ++i) {
      goes_on = Pour(site, connection, attack::LongHeader(attack::After(1, i), kLongHeaderBytes));
    }
    Hold(site, connection);
  });
}

void ContinueHeaders(const AttackSite& site) {
  const std::string more = attack::EndlessContinuation(1);
  OnConnections(site, [&](RawHttp2& connection) {
    bool goes_on = Pour(site, connection, attack::HeadersWithoutEnd(1));
    for (std::size_t i = 0; goes_on && i < kContinuations; ++i) {
      goes_on = Pour(site, connection, more);
    }
    Hold(site, connection);
  });
}

void FloodSettings(const AttackSite& site) {
  Repeat(site, "", http2::Settings({{http2::kMaxConcurrentStreams, 1}}), kFloodFrames);
}

void FloodPings(const AttackSite& site) { Repeat(site, "", http2::Ping(), kFloodFrames); }

void FloodEmptyData(const AttackSite& site) {
  Repeat(site, testing::OpenRelay(1), http2::Data(1, ""), kFloodFrames);
}

void OverflowWindows(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    // The stream's ends it alone, the connection's ends all.
    Pour(site, connection, testing::OpenRelay(1) + http2::WindowUpdate(1, kLargestWindow));
    static_cast<void>(connection.ReadUntil([&] { return connection.At(1).over(); }, kWindowWait));
    Pour(site, connection, http2::WindowUpdate(0, kLargestWindow));
    Hold(site, connection);
  });
}

void OpenNoWindow(const AttackSite& site) {
  OnConnections(site, [&](RawHttp2& connection) {
    connection.Send(http2::Settings({{http2::kInitialWindowSize, 0}}) + testing::OpenRelay(1));
    connection.SendData(1, testing::HelloMessage(1), site.Left());
    for (model::Seq seq = 1; seq <= kRejected && !site.Over() && connection.open(); ++seq) {
      const v1::RelayRequest frame = testing::BatchFrame({{seq, "no message"}});
      const std::string message = testing::WithPrefix(frame.SerializeAsString());
      if (connection.SendData(1, message, site.Left()) < message.size()) break;
    }
    Hold(site, connection);
  });
}

}  // namespace uplink::bench
