#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/identity/peer_identity.h"
#include "server/limits/key_counts.h"
#include "server/transport/probe.h"

namespace uplink::transport {

/// Streams of one robot's certificate: one, two at takeover, four that wait since they come too
/// often, and one more to be told so.
inline constexpr std::size_t kStreamsPerCertificateMax = 8;
/// Streams of one gateway: as many as so many of its connections hold when they are full.
inline constexpr std::size_t kGatewayFullConnections = 4;
/// And no more than this share of all streams: the rest is for all others.
inline constexpr std::size_t kGatewayStreamsPercent = 75;

/// Whose certificate a stream came by. A value.
struct Entrant {
  /// The robot of the certificate; empty of a gateway.
  std::string robot = {};
  /// The subject of a gateway's certificate; empty of a robot.
  std::string gateway = {};
};

[[nodiscard]] Entrant EntrantOf(const identity::PeerIdentity& peer);

/// Admits streams up to a bound, and up to others of each robot's certificate and of each gateway,
/// until the server drains, and knows how many there are. Thread-safe.
class Gate final {
 public:
  struct Limits {
    std::size_t streams_max = 0;
    /// limits.gateway_streams_max, of one connection.
    std::size_t gateway_streams_max = config::LimitsConfig().gateway_streams_max;
  };

  Gate(const Limits& limits, RelayProbe& probe);

  /// A stream wants in. OK means it must Leave. kResourceExhausted at a bound, kUnavailable once
  /// closed; counted by cause.
  [[nodiscard]] absl::Status Enter(const Entrant& entrant);
  void Leave(const Entrant& entrant);
  /// Admits nobody from now on.
  void Close();

  [[nodiscard]] bool closed() const;
  [[nodiscard]] std::size_t streams() const;
  /// Streams that one gateway may have.
  [[nodiscard]] std::size_t per_gateway_max() const { return per_gateway_max_; }
  /// Waits until no stream is left, for `wait` at most; true if none is.
  [[nodiscard]] bool WaitEmpty(milliseconds wait) const;

 private:
  /// Under the lock.
  [[nodiscard]] absl::Status CheckRobot(const std::string& robot) const;
  [[nodiscard]] absl::Status CheckGateway(const std::string& gateway) const;

  const std::size_t streams_max_;
  const std::size_t per_gateway_max_;
  RelayProbe& probe_;
  mutable std::mutex mutex_;
  mutable std::condition_variable empty_;
  std::size_t streams_ = 0;
  /// Of each robot's certificate, and of each gateway, that has one.
  limits::KeyCounts<std::string> by_robot_;
  limits::KeyCounts<std::string> by_gateway_;
  bool closed_ = false;
};

}  // namespace uplink::transport
