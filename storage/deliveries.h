#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/epoch.h"

// What a store remembers of messages that a broker may deliver again. A row never changes, is found
// by its number, and goes when the one DeliveriesKept later comes. So commits of several writers
// under one lease never wait for each other, in whatever order they end.
namespace uplink::storage {

/// Bytes of a client id. A broker must take 23, and most take this many.
inline constexpr std::size_t kClientIdBytesMax = 256;
/// The largest window: twice as many deliveries are remembered, and there are
/// 65,535 packet ids (MQTT 5: 2.2.1).
inline constexpr std::uint32_t kUnackedMaxMax = 32'767;
/// Records of one message at most.
inline constexpr std::uint32_t kMessageRecordsMax = 128;

/// How many deliveries are remembered under a window. A message that is not acked may have a window
/// of others before it and, since acks go in order, as many behind it. Each may be committed, while
/// a kill loses its ack.
[[nodiscard]] constexpr std::uint32_t DeliveriesKept(std::uint32_t unacked_max) {
  return 2 * unacked_max;
}
/// Deliveries of a client id that are remembered.
inline constexpr std::uint32_t kDeliveriesMax = DeliveriesKept(kUnackedMaxMax);

/// The lease of a client id under which messages came (topic_leases.h). Immutable.
struct TopicHold {
  std::string client_id;
  Epoch epoch = 0;
  /// That of the request by which it was taken; all under one epoch have the same. Not what the
  /// broker was asked for (mqtt.unacked_max), but what is remembered.
  std::uint32_t unacked_max = kUnackedMaxMax;
};
/// Shared by all that comes under it.
using TopicHoldRef = std::shared_ptr<const TopicHold>;

/// Of a message's topic and content.
using DeliveryDigest = std::array<std::uint8_t, 16>;

/// One message that a broker delivered, or the end of what was known. A value.
struct Delivery {
  /// Counts a client id's deliveries under one lease, without a hole, from above the number that
  /// its memory names. At most model::kSeqMax. One whose records were fenced keeps its number when
  /// they are committed again.
  std::uint64_t number = 0;
  /// 0, with a number of its own and no digest: the broker lost the session. Deliveries with lower
  /// numbers have ended then, whether they are committed already or later.
  std::uint16_t packet_id = 0;
  /// Nothing: what was known of the packet id has ended, and the message itself is not remembered.
  std::optional<DeliveryDigest> digest;

  friend bool operator==(const Delivery&, const Delivery&) = default;
};

/// Stands on the last record of a message that a broker delivered. A value.
struct MessageEnd {
  /// Remembered with the records, unless one of them is fenced: the message itself, if it may come
  /// again, and what came before it of the same robot and left no record. Not empty.
  std::vector<Delivery> deliveries;
  /// Of the message, this one included: they stand one after the other in one batch, are of one
  /// robot and came under one lease. 1 to kMessageRecordsMax.
  std::uint32_t records = 1;
};

/// What one transaction remembers under one lease besides the messages whose records it has, such
/// as that the broker lost the session.
struct Deliveries {
  TopicHoldRef hold;
  /// In no order: several writers commit one client id's at a time.
  std::vector<Delivery> rows;
};

/// What is known of a client id's deliveries. A value.
struct DeliveryMemory {
  /// The next delivery has a greater number.
  std::uint64_t last_number = 0;
  /// By packet id the latest, those that ended left out; in order of their numbers.
  std::vector<Delivery> known;
};

/// Makes a memory of what rows say: the latest of each packet id counts, behind the last session
/// that was lost; those without a digest ended. `rows` ascend by number.
[[nodiscard]] DeliveryMemory MemoryOf(const std::vector<Delivery>& rows);

/// The memory with which a lease begins: what is known of the last `kept_max` numbers, numbered
/// anew without a hole, above all numbers that were given. So numbers that were given and not
/// committed move nothing out of memory, however often the process ends.
[[nodiscard]] DeliveryMemory NumberedAnew(DeliveryMemory memory, std::uint32_t kept_max);

}  // namespace uplink::storage
