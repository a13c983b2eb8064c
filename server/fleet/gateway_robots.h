#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <string>
#include <unordered_map>

#include "server/limits/key_counts.h"

namespace uplink::fleet {

/// Robots in memory that one gateway may bring in without a certificate that names them: four times
/// as many as it may have streams (transport::kGatewayFullConnections) at the default of
/// limits.gateway_streams_max.
inline constexpr std::size_t kGatewayRobotsMax = 4'096;
/// And at most this share of limits.robots_max: the rest is for all others.
inline constexpr std::size_t kGatewayRobotsPercent = 75;

[[nodiscard]] constexpr std::size_t GatewayRobotsMax(std::size_t robots_max) {
  return std::clamp<std::size_t>(robots_max * kGatewayRobotsPercent / 100, 1, kGatewayRobotsMax);
}

/// The robots in memory that a gateway brought in: its certificate names their fleet, not them. The
/// bound keeps a stolen key from filling the fleet with invented robots. Robots that came by a
/// certificate that names them, and robots that the store knew before, are not counted.
///
/// Bounds: one entry per robot in memory; `per_gateway_max` entries for one gateway.
/// Thread: thread-safe; the lock is held for one lookup.
class GatewayRobots final {
 public:
  explicit GatewayRobots(std::size_t per_gateway_max) : per_gateway_max_(per_gateway_max) {}

  /// The gateway brings in a robot that is not in memory. False if the gateway is at its bound.
  [[nodiscard]] bool Add(const std::string& ruri, const std::string& gateway);
  /// The robot came by a certificate that names it, or has left memory.
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
