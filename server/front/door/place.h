#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "server/front/door/door_book.h"
#include "server/front/tls/tls_peer.h"

namespace uplink::front {

/// Connections of one public key. A robot has more than one only until the old one is known to be
/// gone; a gateway may spread its robots over several, and an operator's programs share a key or a
/// token.
inline constexpr std::size_t kRobotConnectionsMax = 4;
inline constexpr std::size_t kGatewayConnectionsMax = 16;

/// A connection's place among those that have shown a certificate, from Take to Leave: it counts
/// among all, and among those of its key. Without a place it may be one of the few that linger.
/// Confined to its connection's thread.
class Place final {
 public:
  Place(DoorBook& book, std::uint64_t connection) : book_(book), connection_(connection) {}
  ~Place() { Leave(); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// False if no place is free.
  [[nodiscard]] bool Take();
  /// Adds it to its key's connections; returns the one to evict.
  [[nodiscard]] std::optional<std::uint64_t> Count(const TlsPeer& peer, const Origin& origin,
                                                   SteadyTime now);
  /// It counts among those of this caller from now on, no more among those of its source. Returns
  /// the one to evict.
  [[nodiscard]] std::optional<std::uint64_t> CountAs(const KeyDigest& caller, const Origin& origin,
                                                     SteadyTime now);
  /// The peer sent something. Mostly free.
  void NoteHeard(SteadyTime now);
  void SetStreams(std::size_t streams);
  /// Whether the connection may linger, now that it has sent everything. It lingers in its place,
  /// and is the first to give way; if it was evicted, it takes one of DoorBook::lingers. `key`: the
  /// key that it has shown, if any.
  [[nodiscard]] bool Linger(const std::optional<KeyDigest>& key);
  void Leave();

 private:
  DoorBook& book_;
  const std::uint64_t connection_;
  bool taken_ = false;
  /// It is one of DoorBook::lingers.
  bool lingers_ = false;
  std::optional<KeyDigest> lingers_as_;
  /// When the table of keys was last told that it was heard.
  SteadyTime noted_at_{};
};

}  // namespace uplink::front
