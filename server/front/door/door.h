#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <unordered_map>

#include "server/front/door/door_book.h"
#include "server/front/door/handshake_queue.h"
#include "server/front/loop/descriptor.h"

namespace uplink::front {

/// Limits of connections, by what they have shown: a certificate, an address, or nothing yet.
struct DoorLimits {
  DoorBook::Limits book;
  HandshakeLimits handshakes;
  /// Connections whose load balancer has not yet said where they come from.
  std::size_t proxy_headers_max = 0;
};

/// Whether load balancers say where connections come from.
enum class ProxyHeaders : std::uint8_t { kNone, kExpected };

struct DoorNeeds {
  std::size_t streams_max = 0;
  /// Descriptors that the process may have.
  std::size_t descriptors_max = 0;
  /// Descriptors for the store, HTTP, files and our own handshake with our listener; at most a
  /// quarter counts.
  std::size_t reserved = 0;
  ProxyHeaders headers = ProxyHeaders::kNone;
};

/// The limits for these needs: connections without a certificate never take the place of those
/// with one, and the reserve is kept.
[[nodiscard]] DoorLimits DoorLimitsFor(const DoorNeeds& needs);

/// An accepted connection, and where it comes from.
struct IncomingConnection {
  Descriptor descriptor;
  Origin origin;
};

/// Decides who may begin a handshake, and when. Until a certificate was shown, sources share the
/// places.
///
/// Thread: confined to the acceptor's.
class Door final {
 public:
  struct Actions {
    /// Begins the handshake of this connection; HandshakeBegan and HandshakeEnded follow.
    std::function<void(std::uint64_t id, IncomingConnection incoming)> admit;
    /// Cuts this handshake, which has begun; HandshakeEnded follows.
    std::function<void(std::uint64_t id)> cut;
  };

  Door(const HandshakeLimits& limits, DoorBook& book, transport::RelayProbe& probe,
       Actions actions);
  /// Closes what waits.
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  void Arrive(IncomingConnection incoming, SteadyTime now);
  /// The handshake waits for its peer from now on. Before, it waited for our CPU alone and could
  /// not be cut.
  void HandshakeBegan(std::uint64_t id, SteadyTime now);
  /// The handshake has ended, with or without success.
  void HandshakeEnded(std::uint64_t id, SteadyTime now);
  /// A second has passed: long handshakes may have to give way.
  void Tick(SteadyTime now);
  [[nodiscard]] std::size_t waiting() const { return queue_.waiting(); }

 private:
  void Admit(SteadyTime now);
  void Publish();

  DoorBook& book_;
  transport::RelayProbe& probe_;
  const Actions actions_;
  HandshakeQueue queue_;
  std::uint64_t next_id_ = 1;
  std::unordered_map<std::uint64_t, IncomingConnection> waiting_;
  /// When the handshakes that have begun did so.
  std::unordered_map<std::uint64_t, SteadyTime> began_;
};

}  // namespace uplink::front
