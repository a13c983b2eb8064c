#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tests/bench/cyberwave/messages.h"

namespace uplink::bench {

/// Connections that publish packets made before: they must never be what a benchmark waits for.
///
/// Errors: a broker that ends a connection aborts the benchmark.
/// Thread: confined to one thread.
class Publishers final {
 public:
  /// Connects to a broker of this machine. The packet at i leaves on connection i % `connections`.
  Publishers(std::uint16_t port, std::size_t connections, std::vector<PublishPacket> packets,
             const Clock& clock);
  ~Publishers();
  Publishers(const Publishers&) = delete;
  Publishers& operator=(const Publishers&) = delete;

  /// Publishes so many packets per second, evenly, for so long.
  void Pace(double per_second, milliseconds duration);

  /// How far packets at QoS 1 may be ahead. A value.
  struct Ahead {
    /// Of the broker's PUBACKs, on each connection.
    std::size_t window = 0;
    /// Of the subscriber, in all.
    std::uint64_t backlog = 0;
  };
  /// Publishes at QoS 1 as fast as that lets it, for so long. `settled` says how many packets the
  /// subscriber is done with; it is asked about each kLookEvery.
  void Flood(const Ahead& ahead, const std::function<std::uint64_t()>& settled,
             milliseconds duration);
  static constexpr milliseconds kLookEvery{200};

  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  /// Packets that left over 100 ms late.
  [[nodiscard]] std::uint64_t late() const { return late_; }

 private:
  struct Connection {
    int socket = -1;
    std::string out;
    std::string in;
    std::size_t unacked = 0;
    std::uint16_t last_id = 0;
  };

  void Connect(Connection& connection, std::uint16_t port, std::size_t number) const;
  /// Queues the next packet on its connection.
  void Put();
  [[nodiscard]] Connection& NextConnection() { return connections_[next_ % connections_.size()]; }
  static void Write(Connection& connection);
  /// Reads PUBACKs.
  static void Read(Connection& connection);
  /// Writes and reads what can be, waiting so long at most for something to do.
  void Work(std::chrono::nanoseconds wait_max);

  const Clock& clock_;
  std::vector<PublishPacket> packets_;
  std::vector<Connection> connections_;
  std::size_t next_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace uplink::bench
