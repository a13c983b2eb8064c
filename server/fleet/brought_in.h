#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

#include "server/limits/key_counts.h"

namespace uplink::fleet {

/// Robots in memory that one gateway may have brought in by the word for its fleet: four times as
/// many as it may have streams (transport::kGatewayFullConnections) at the default of
/// limits.gateway_streams_max.
inline constexpr std::size_t kGatewayRobotsMax = 4'096;
/// And no more than this share of limits.robots_max: the rest is for all others.
inline constexpr std::size_t kGatewayRobotsPercent = 75;

[[nodiscard]] constexpr std::size_t GatewayRobotsMax(std::size_t robots_max) {
  return std::clamp<std::size_t>(robots_max * kGatewayRobotsPercent / 100, 1, kGatewayRobotsMax);
}

/// Which robots are in memory by nothing but a gateway's word for its fleet: whoever holds such a
/// gateway's key could invent robots without end, and would fill the fleet. Those that came by a
/// certificate that names them are not counted, nor those that the store knew before.
///
/// Bounds: as many entries as robots are in memory; of one gateway `per_gateway_max`.
/// Thread: thread-safe; the lock is held for a look alone.
class BroughtIn final {
 public:
  explicit BroughtIn(std::size_t per_gateway_max) : per_gateway_max_(per_gateway_max) {}

  /// The gateway brings in a robot that is not in memory. False if it may bring no more.
  [[nodiscard]] bool Add(const std::string& ruri, const std::string& gateway);
  /// The robot came by a certificate that names it, or is no more in memory.
  void Remove(const std::string& ruri);

  [[nodiscard]] std::size_t of(const std::string& gateway) const;
  [[nodiscard]] std::size_t per_gateway_max() const { return per_gateway_max_; }

 private:
  const std::size_t per_gateway_max_;
  mutable std::mutex mutex_;
  /// The gateway of each robot, and how many each has.
  std::unordered_map<std::string, std::string> gateways_;
  limits::KeyCounts<std::string> counts_;
};

}  // namespace uplink::fleet
