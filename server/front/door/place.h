#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "server/front/door/door_book.h"
#include "server/front/tls/tls_peer.h"

namespace uplink::front {

/// Connections of one public key: more than one only while an old one is not known to be gone, and
/// a gateway's may spread its robots.
inline constexpr std::size_t kRobotConnectionsMax = 4;
inline constexpr std::size_t kGatewayConnectionsMax = 16;

/// The place that a connection has among those that have shown a certificate, from Take until it is
/// left: the number of all, and those of its key. Without one it may have one of the few among
/// those that linger. Confined to its connection's thread.
class Place final {
 public:
  Place(DoorBook& book, std::uint64_t connection) : book_(book), connection_(connection) {}
  ~Place() { Leave(); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// False if there is none.
  [[nodiscard]] bool Take();
  /// Adds it to its key's connections; returns the one to evict.
  [[nodiscard]] std::optional<std::uint64_t> Count(const TlsPeer& peer, const Origin& origin,
                                                   SteadyTime now);
  /// The peer said something. Costs nothing most times.
  void NoteHeard(SteadyTime now);
  void SetStreams(std::size_t streams);
  /// Its last word is said: whether it may stay for a moment. It does in the place that it has,
  /// where it is the first to give way; one that was evicted from its key's has that no more.
  /// `key`: what it has shown, if anything.
  [[nodiscard]] bool Linger(const std::optional<KeyDigest>& key);
  void Leave();

 private:
  DoorBook& book_;
  const std::uint64_t connection_;
  bool taken_ = false;
  /// It is one of DoorBook::lingers.
  bool lingers_ = false;
  std::optional<KeyDigest> lingers_as_;
  /// When the table of keys was told last that it was heard.
  SteadyTime noted_at_{};
};

}  // namespace uplink::front
