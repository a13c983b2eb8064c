#pragma once

#include <atomic>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// Numbers for connections, from 1, each used once. Shared by all clients of a process: a handle
/// names its connection by such a number, and must mean nothing to a later client.
///
/// Thread: any.
class ConnectionNumbers final {
 public:
  [[nodiscard]] std::uint64_t Next() { return ++last_; }

 private:
  std::atomic<std::uint64_t> last_{0};
};

/// A delivery of a PUBLISH at QoS 1 to ack, on one connection of this process. A value; only the
/// client that made it understands it.
struct AckHandle {
  /// By ConnectionNumbers; 0 means none.
  std::uint64_t connection = 0;
  /// Deliveries of one connection are numbered from 0.
  std::uint64_t number = 0;

  friend bool operator==(const AckHandle&, const AckHandle&) = default;
};

/// The unacked PUBLISHes at QoS 1 of one connection, in the order in which they came. PUBACKs go
/// out in that order: one that is released early waits for those before it.
///
/// **Repeated ids.** A broker gives an id to another message only after it got our PUBACK for it.
/// So:
/// - with DUP, while the id is unacked: the same message again (brokers that resend by a timer). It
///   has the handle, and the place in order, of its first delivery, and both together get one
///   PUBACK. A second one could reach the broker after the id went to another message, and would
///   ack that one before it is stored.
/// - with DUP, after we acked the id on this connection: the same message again, sent before our
///   PUBACK came. It gets no second one, for the same reason, and needs none: the first arrives, or
///   the connection ends. An id that this connection did not ack is another matter: a broker may
///   deliver with DUP what an earlier connection had.
/// - without DUP, while the id is unacked: a new message. The broker is done with the older one,
///   because a PUBACK of an earlier delivery crossed with a resending, so the older one gets none;
///   it keeps its place in order.
///
/// Limits:  `unacked_max` entries; the caller checks full() before Add.
/// Thread:  confined to its client's.
/// Source:  MQTT 3.1.1, 4.3.2 and 4.6; MQTT 5.0, 4.3.2, 4.4 and 4.6.
class Unacked final {
 public:
  Unacked(std::uint64_t connection, std::size_t unacked_max)
      : connection_(connection), unacked_max_(unacked_max) {}

  [[nodiscard]] bool full() const { return entries_.size() >= unacked_max_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  struct Delivery {
    /// Empty if this connection already acked it.
    std::optional<AckHandle> handle;
    /// This connection delivered it before.
    bool again = false;
  };
  /// Must not be called when full.
  Delivery Add(PacketId id, bool dup);

  /// The core is done with a delivery. Returns the ids whose PUBACK is due now, in order. Handles
  /// of other connections, or released ones, have no effect.
  [[nodiscard]] std::vector<PacketId> Release(const AckHandle& handle);
  /// True if the handle is of this connection and was not released.
  [[nodiscard]] bool Holds(const AckHandle& handle) const;

 private:
  struct Entry {
    PacketId id = 0;
    bool released = false;
    /// Its id went to another message.
    bool replaced = false;
  };

  const std::uint64_t connection_;
  const std::size_t unacked_max_;
  std::deque<Entry> entries_;
  /// The number of the first entry.
  std::uint64_t first_ = 0;
  /// The numbers of entries that are not replaced, by id.
  std::unordered_map<PacketId, std::uint64_t> number_of_;
  static constexpr std::size_t kIds = std::size_t{1} << 16U;
  /// Ids that were acked, and have not come without DUP since.
  std::bitset<kIds> acked_;
};

}  // namespace uplink::mqtt
