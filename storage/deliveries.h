#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/epoch.h"

// What a store remembers of messages that a broker may deliver again (README.md: Redeliveries).
namespace uplink::storage {

/// Bytes of a client id. A broker must take 23, and most take this many.
inline constexpr std::size_t kClientIdBytesMax = 256;
/// Deliveries of a client id that are remembered: there are no more packet ids (MQTT 5: 2.2.1).
inline constexpr std::uint32_t kDeliveriesMax = 65'535;

/// The lease of a client id under which messages came (topic_leases.h). Immutable.
struct TopicHold {
  std::string client_id;
  Epoch epoch = 0;
};
/// Shared by all that comes under it.
using TopicHoldRef = std::shared_ptr<const TopicHold>;

/// Of a message's topic and content.
using DeliveryDigest = std::array<std::uint8_t, 16>;

/// One message that a broker delivered. A value.
struct Delivery {
  /// Counts a client id's deliveries, from 1, without a hole, over all processes that ever held its
  /// lease. At most model::kSeqMax.
  std::uint64_t number = 0;
  std::uint16_t packet_id = 0;
  /// Nothing: what was known of the packet id has ended, and the message itself is not remembered.
  std::optional<DeliveryDigest> digest;

  friend bool operator==(const Delivery&, const Delivery&) = default;
};

/// What one transaction remembers of the deliveries under one lease.
struct Deliveries {
  TopicHoldRef hold;
  /// Of the messages whose records the batch has, or the last of them. In no order: several writers
  /// commit one client id's at a time.
  std::vector<Delivery> committed;
  /// Deliveries below this number have ended, whether they are committed already or later: the
  /// broker lost the session. 0: nothing ended.
  std::uint64_t forget_below = 0;
  /// How many are remembered: the numbers up to this far below one that is committed go
  /// (mqtt.unacked_max; 1 to kDeliveriesMax).
  std::uint32_t kept_max = kDeliveriesMax;
};

/// What is known of a client id's deliveries. A value.
struct DeliveryMemory {
  /// The next delivery has a greater number.
  std::uint64_t last_number = 0;
  /// By packet id the latest, those that ended left out; in order of their numbers.
  std::vector<Delivery> known;
};

/// Makes a memory of what rows say: the latest of each packet id counts, those below `forget_below`
/// and those without a digest ended. `rows` ascend by number.
[[nodiscard]] DeliveryMemory MemoryOf(const std::vector<Delivery>& rows,
                                      std::uint64_t forget_below);

}  // namespace uplink::storage
