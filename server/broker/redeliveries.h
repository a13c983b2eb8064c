#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "storage/deliveries.h"

namespace uplink::broker {

/// The messages at QoS 1 that the broker may deliver again, by packet id: those that wait for their
/// commit, the last ones that were committed, and the last ones that were settled without a record.
/// The store remembers the committed ones with their rows, so that the next process begins with
/// them. It also gets the settled ones that came before a committed one of their twin: processed
/// again as new, they would come after it. It also learns which of its own have expired, because a
/// message without a record has their packet id now. Otherwise a later message with that id and the
/// same content would count as a redelivery of them.
///
/// Limits:  one entry per packet id: 65,535.
/// Thread:  confined to its owner's.
class Redeliveries final {
 public:
  /// `kept_max` as storage::DeliveriesKept.
  explicit Redeliveries(std::uint32_t kept_max) : kept_max_(kept_max), last_ordinal_(kept_max) {}

  /// Begins under a new lease with what the store knows. What waits here is known better.
  void Begin(const storage::DeliveryMemory& memory) {
    expired_.clear();
    Load(memory, false);
  }
  /// The store is about to be read, and may have lost commits. Messages that were settled because
  /// of what the store had are forgotten, so they are judged again. None is followed by a record of
  /// its twin, since that would have given it a number.
  void BeginReread();
  /// As Begin, but under the same lease, with what the store knew at some time after BeginReread.
  /// Commits since then, and what the store was never told, stay known.
  void Reread(const storage::DeliveryMemory& memory) { Load(memory, true); }

  enum class Known : std::uint8_t { kNo, kWaits, kSettled };
  /// Whose message was settled without a record, and why. A value.
  struct SettledFor {
    /// The stream of its twin; 0 if it has none.
    std::uint64_t stream = 0;
    /// The shard of its twin, if it left no record because of what the store has of that twin.
    std::optional<std::size_t> rests_on{};
  };
  struct Found {
    Known known = Known::kNo;
    /// If it waits: its stream and its number.
    std::uint64_t stream = 0;
    std::uint64_t number = 0;
    /// If it is settled: as SettledFor's.
    std::optional<std::size_t> rests_on{};
  };
  /// What is known of a message that the broker marked as sent before (DUP).
  [[nodiscard]] Found Find(std::uint16_t packet_id, const storage::DeliveryDigest& digest) const;

  /// The next number, for a new message.
  [[nodiscard]] std::uint64_t NextNumber() { return ++last_number_; }
  /// A new message waits under the id, and replaces the old one.
  void AddWaiting(const storage::Delivery& delivery, std::uint64_t stream);
  /// A new message under the id is settled without a record.
  void AddSettled(std::uint16_t packet_id, const storage::DeliveryDigest& digest,
                  const SettledFor& settled);
  /// Reduces the packet ids to those of messages that were settled for this stream, may come again,
  /// and are not in the store; each once, oldest first.
  void KeepSettled(std::uint64_t stream, std::vector<std::uint16_t>& packet_ids) const;
  /// Gives these messages numbers for the store. The caller then reports each by Commit or Drop.
  [[nodiscard]] std::vector<storage::Delivery> Number(std::uint64_t stream,
                                                      std::vector<std::uint16_t> packet_ids);
  /// A new message under the id is settled at once and not remembered.
  void Expire(std::uint16_t packet_id);
  /// Deliveries that the store knows, or will know, and that expired since the last call.
  [[nodiscard]] std::vector<storage::Delivery> TakeExpired();
  /// The message was committed.
  void Commit(std::uint16_t packet_id, std::uint64_t number);
  /// The message never will be committed: it is new when it comes again.
  void Drop(std::uint16_t packet_id, std::uint64_t number);
  /// As Drop, for messages that were settled without a record for that stream and got no number.
  void DropSettled(std::uint64_t stream, std::vector<std::uint16_t> packet_ids);

  /// The broker lost the session: no known message comes again. Returns what the store must
  /// remember of that.
  [[nodiscard]] storage::Delivery EndSession();

 private:
  struct Entry {
    /// 0: the store does not have it.
    std::uint64_t number = 0;
    /// The position among all messages at QoS 1, numbered or not. Packet ids are used again in that
    /// order.
    std::uint64_t ordinal = 0;
    /// Empty: it would not be recognized if it came again.
    std::optional<storage::DeliveryDigest> digest;
    /// 0 if it is settled.
    std::uint64_t stream = 0;
    /// For a message without a record; its stream is 0 once it has a number.
    SettledFor settled{};
    /// It was committed after the last BeginReread.
    bool is_fresh = false;
    /// It was settled without a record, and the store does not know: it has no number, or its
    /// number goes with a commit that is under way.
    bool is_untold = false;
  };
  /// Gives the packet id to a message without a record.
  void Replace(std::uint16_t packet_id, const Entry& entry);
  /// The broker does not deliver it again, since all ids were used after it.
  [[nodiscard]] bool IsOld(const Entry& entry) const {
    return entry.ordinal + kept_max_ <= last_ordinal_;
  }
  void Load(const storage::DeliveryMemory& memory, bool keep_settled);

  const std::uint32_t kept_max_;
  std::uint64_t last_number_ = 0;
  /// The store keeps numbers alone, which are at most as far apart as the ordinals.
  std::uint64_t last_ordinal_;
  std::unordered_map<std::uint16_t, Entry> known_;
  /// Packet ids under which the store knows an expired delivery; each once until it gets a number.
  std::vector<std::uint16_t> expired_;
};

}  // namespace uplink::broker
