#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/uplinkd_folder.h"
#include "tools/link/tls_client.h"

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
  /// Certificates of so many gateways, which name robots of MakeRobots in equal parts: robot i is
  /// gateway i % gateways'.
  [[nodiscard]] std::vector<link::Identity> MakeGateways(std::size_t gateways,
                                                         std::size_t robots) const;

  testing::UplinkdFolder folder;
  std::vector<link::Identity> identities;
};

}  // namespace uplink::bench
