#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/identity/peer_identity.h"
#include "server/limits/key_counts.h"
#include "server/transport/probe.h"

namespace uplink::transport {

/// Streams of one robot's certificate: one, two at takeover, four that wait because they come too
/// often, and one more that is refused with a reason.
inline constexpr std::size_t kStreamsPerCertificateMax = 8;
/// Calls of one robot's certificate: those of one drone in flight, those that are refused as too
/// many, and as many again on a connection that broke without our notice.
inline constexpr std::size_t kCallsPerCertificateMax = 256;
/// The least bound for all calls together: where few robots are expected, a drone still has room.
inline constexpr std::size_t kCallsMaxAtLeast = 1024;
/// One gateway may have as many streams, and as many calls besides, as so many full connections.
inline constexpr std::size_t kGatewayFullConnections = 4;
/// But at most this share of all streams, and of all calls: the rest is for all others.
inline constexpr std::size_t kGatewayStreamsPercent = 75;

/// Whether a call counts among streams, which stay, among calls, which are answered soon, or among
/// checks of the health, which strangers may make: they take no place of the others.
enum class Admission : std::uint8_t { kStream, kCall, kHealth };

/// The certificate by which a stream came. A value.
struct Entrant {
  /// The robot of the certificate; empty for a gateway.
  std::string robot = {};
  /// The subject of a gateway's certificate; empty for a robot.
  std::string gateway = {};
};

[[nodiscard]] Entrant EntrantOf(const identity::PeerIdentity& peer);

/// Admits streams until the server drains, and counts them: up to a bound for all, for each robot's
/// certificate and for each gateway. Calls have bounds of their own, so that neither takes the
/// other's places. Thread-safe.
class Gate final {
 public:
  struct Limits {
    /// The bound of streams, and those of calls and of checks of the health, which are at least
    /// kCallsMaxAtLeast.
    std::size_t streams_max = 0;
    /// limits.gateway_streams_max, for one connection.
    std::size_t gateway_streams_max = config::LimitsConfig().gateway_streams_max;
  };

  Gate(const Limits& limits, RelayProbe& probe);

  /// Admits a stream or call; after OK it must Leave. Otherwise kResourceExhausted at a bound, or
  /// kUnavailable once closed; counted by cause.
  [[nodiscard]] absl::Status Enter(const Entrant& entrant,
                                   Admission admission = Admission::kStream);
  void Leave(const Entrant& entrant, Admission admission = Admission::kStream);
  /// Admits no stream and no call from now on.
  void Close();

  [[nodiscard]] bool closed() const;
  /// Streams, calls and checks.
  [[nodiscard]] std::size_t streams() const;
  /// Streams that one gateway may have.
  [[nodiscard]] std::size_t per_gateway_max() const { return here_[0].per_gateway_max; }
  /// Waits until no stream and no call is left, for `wait` at most; true if none is.
  [[nodiscard]] bool WaitEmpty(milliseconds wait) const;

 private:
  /// The bounds and counts of one kind of admission.
  struct Here {
    const std::size_t max;
    const std::size_t per_gateway_max;
    std::size_t all = 0;
    /// The counts of each robot's certificate, and of each gateway, that has any.
    limits::KeyCounts<std::string> by_robot{};
    limits::KeyCounts<std::string> by_gateway{};
  };

  // Under the lock.
  [[nodiscard]] absl::Status CheckRobot(const std::string& robot, Admission admission) const;
  [[nodiscard]] absl::Status CheckGateway(const std::string& gateway, Admission admission) const;
  [[nodiscard]] std::size_t All() const { return here_[0].all + here_[1].all + here_[2].all; }

  RelayProbe& probe_;
  mutable std::mutex mutex_;
  mutable std::condition_variable empty_;
  /// By Admission.
  std::array<Here, 3> here_;
  bool closed_ = false;
};

}  // namespace uplink::transport
