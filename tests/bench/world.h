#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/uplinkd_folder.h"
#include "tools/link/tls_link.h"

namespace uplink::bench {

/// The core that servers run on, and that of the load. With one core, both are that.
inline constexpr int kServerCore = 0;
inline constexpr int kLoadCore = 1;
/// Binds this thread, and what it starts, to a core; false if the machine has none of that number.
bool PinTo(int core);
/// Before a load begins: a peer that is gone ends no program, and as many connections are open as
/// the system allows.
void PrepareLoad();

/// Robots' certificates, and which authorities servers and robots trust; for a whole run.
struct World {
  /// Makes certificates until there are so many.
  void MakeRobots(std::size_t robots);
  /// A certificate for that.
  [[nodiscard]] link::Identity Issue(const testing::CertificateSpec& spec) const;
  /// Certificates of so many gateways, which name robots of MakeRobots in equal parts: robot i is
  /// gateway i % gateways'.
  [[nodiscard]] std::vector<link::Identity> MakeGateways(std::size_t gateways,
                                                         std::size_t robots) const;

  /// The way to a server of this machine, without an identity.
  [[nodiscard]] link::LinkOptions LinkTo(std::uint16_t port,
                                         link::Alpn alpn = link::Alpn::kHttp2) const;

  testing::UplinkdFolder folder;
  std::vector<link::Identity> identities;
};

}  // namespace uplink::bench
