#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "schema/model/rejection.h"

namespace uplink::broker {

/// What became of a message. Closed; metrics have the names.
enum class Became : std::uint8_t {
  /// All that it brought is committed.
  kStored,
  /// It is live, and what it says is held.
  kApplied,
  /// It is live, and older than what its session said last.
  kSuperseded,
  /// The broker delivered it again, and it waits or is settled already.
  kDuplicate,
  /// For a reason; its row of quarantine is committed, if it has one.
  kRejected,
  /// Not taken, through no fault of its own: no room, too many robots, or another server
  /// adopted its robot.
  /// A durable one at QoS 1 is not acked, and comes again.
  kRefused,
  /// A command, signalling, media, or a ping: counted, and a ping answered.
  kObserved,
  /// Retained, or on a topic that we do not know.
  kIgnored,
};
inline constexpr auto kBecameNames = std::to_array<std::string_view>(
    {"stored", "applied", "superseded", "duplicate", "rejected", "refused", "observed", "ignored"});

/// What happened to messages: the columns of received = the sum of what they became + in flight. A
/// value.
struct MessageCounts {
  std::uint64_t received = 0;
  std::array<std::uint64_t, kBecameNames.size()> became{};
  /// Change of the number of messages that were received and are not settled.
  std::int64_t in_flight = 0;
  /// Of those rejected; index: RejectReason.
  std::array<std::uint64_t, model::kRejectReasons + 1> rejects{};
  /// Fields that live messages went without; index: RejectReason.
  std::array<std::uint64_t, model::kRejectReasons + 1> dropped{};

  void Count(Became what) { ++became[static_cast<std::size_t>(what)]; }
  MessageCounts& operator+=(const MessageCounts& other);
  /// True when the law holds.
  [[nodiscard]] bool Balanced() const;
};

/// The counts of a broker's messages. What belongs together is published together, so that the law
/// holds at every moment. Thread-safe.
class MessageLedger final {
 public:
  void Publish(const MessageCounts& delta);
  [[nodiscard]] MessageCounts Read() const;

 private:
  mutable std::mutex mutex_;
  MessageCounts counts_;
};

}  // namespace uplink::broker
