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

/// How many connections there may be, by what they have shown.
struct DoorLimits {
  DoorBook::Limits book;
  HandshakeLimits handshakes;
  /// Those whose load balancer has not said where they come from.
  std::size_t proxy_headers_max = 0;
};

/// Whether load balancers say where connections come from.
enum class ProxyHeaders : std::uint8_t { kNone, kExpected };

struct DoorNeeds {
  std::size_t streams_max = 0;
  /// Of the process.
  std::size_t descriptors_max = 0;
  /// For the store, HTTP, files and our own handshake with our listener; a quarter at most.
  std::size_t reserved = 0;
  ProxyHeaders headers = ProxyHeaders::kNone;
};

/// The limits for that: what has shown no certificate never takes the place of what has, and the
/// reserve is left.
[[nodiscard]] DoorLimits DoorLimitsFor(const DoorNeeds& needs);

/// A connection that was accepted.
struct Visitor {
  Descriptor descriptor;
  Origin origin;
};

/// Who may begin a handshake, and when: until a certificate was shown, sources share the places.
///
/// Thread: confined to the acceptor's.
class Door final {
 public:
  struct Actions {
    /// The handshake of this connection is to begin; HandshakeBegan and HandshakeEnded follow.
    std::function<void(std::uint64_t id, Visitor visitor)> admit;
    /// The handshake, which has begun, is cut short; HandshakeEnded follows.
    std::function<void(std::uint64_t id)> cut;
  };

  Door(const HandshakeLimits& limits, DoorBook& book, transport::RelayProbe& probe,
       Actions actions);
  /// Closes what waits.
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  void Arrive(Visitor visitor, SteadyTime now);
  /// The handshake waits for its peer from now on: until then it waits for our own CPU alone, and
  /// gives way to nobody.
  void HandshakeBegan(std::uint64_t id, SteadyTime now);
  /// The handshake is over, whatever came of it.
  void HandshakeEnded(std::uint64_t id, SteadyTime now);
  /// A second has passed: handshakes that have become long may give way.
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
  std::unordered_map<std::uint64_t, Visitor> waiting_;
  /// When those of the handshakes under way began that have begun.
  std::unordered_map<std::uint64_t, SteadyTime> began_;
};

}  // namespace uplink::front
