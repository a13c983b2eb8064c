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

/// Streams of one robot's certificate: one, two at takeover, four that wait since they come too
/// often, and one more to be told so.
inline constexpr std::size_t kStreamsPerCertificateMax = 8;
/// Calls of one robot's certificate: those of one drone in flight, those that are told that these
/// are too many, and as many again of a connection that broke and was not missed yet.
inline constexpr std::size_t kCallsPerCertificateMax = 256;
/// Calls of all together, at least: where few robots are expected, a drone still has its own.
inline constexpr std::size_t kCallsMaxAtLeast = 1024;
/// Streams of one gateway, and calls besides: as many as so many of its connections hold when they
/// are full.
inline constexpr std::size_t kGatewayFullConnections = 4;
/// And no more than this share of all of them: the rest is for all others.
inline constexpr std::size_t kGatewayStreamsPercent = 75;

/// In which bounds a call counts: those of streams, which stay, or those of calls, which are
/// answered soon.
enum class Admission : std::uint8_t { kStream, kCall };

/// Whose certificate a stream came by. A value.
struct Entrant {
  /// The robot of the certificate; empty of a gateway.
  std::string robot = {};
  /// The subject of a gateway's certificate; empty of a robot.
  std::string gateway = {};
};

[[nodiscard]] Entrant EntrantOf(const identity::PeerIdentity& peer);

/// Admits streams up to a bound, and up to others of each robot's certificate and of each gateway,
/// until the server drains, and knows how many there are. Calls count beside streams, so that
/// neither takes the others' places. Thread-safe.
class Gate final {
 public:
  struct Limits {
    /// Of streams, and of calls besides, which have kCallsMaxAtLeast if this is less.
    std::size_t streams_max = 0;
    /// limits.gateway_streams_max, of one connection.
    std::size_t gateway_streams_max = config::LimitsConfig().gateway_streams_max;
  };

  Gate(const Limits& limits, RelayProbe& probe);

  /// A stream wants in. OK means it must Leave. kResourceExhausted at a bound, kUnavailable once
  /// closed; counted by cause.
  [[nodiscard]] absl::Status Enter(const Entrant& entrant,
                                   Admission admission = Admission::kStream);
  void Leave(const Entrant& entrant, Admission admission = Admission::kStream);
  /// Admits nobody from now on.
  void Close();

  [[nodiscard]] bool closed() const;
  /// With calls.
  [[nodiscard]] std::size_t streams() const;
  /// Streams that one gateway may have.
  [[nodiscard]] std::size_t per_gateway_max() const { return here_[0].per_gateway_max; }
  /// Waits until no stream and no call is left, for `wait` at most; true if none is.
  [[nodiscard]] bool WaitEmpty(milliseconds wait) const;

 private:
  /// What is here of one kind of admission.
  struct Here {
    const std::size_t max;
    const std::size_t per_gateway_max;
    std::size_t all = 0;
    /// Of each robot's certificate, and of each gateway, that has one.
    limits::KeyCounts<std::string> by_robot{};
    limits::KeyCounts<std::string> by_gateway{};
  };

  // Under the lock.
  [[nodiscard]] absl::Status CheckRobot(const std::string& robot, Admission admission) const;
  [[nodiscard]] absl::Status CheckGateway(const std::string& gateway, Admission admission) const;
  [[nodiscard]] std::size_t All() const { return here_[0].all + here_[1].all; }

  RelayProbe& probe_;
  mutable std::mutex mutex_;
  mutable std::condition_variable empty_;
  /// By Admission.
  std::array<Here, 2> here_;
  bool closed_ = false;
};

}  // namespace uplink::transport
