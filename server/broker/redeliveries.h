#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "storage/deliveries.h"

namespace uplink::broker {

/// Which messages at QoS 1 the broker may deliver again, by their packet ids: those that wait for
/// their commit, the last ones that were committed, and the last ones that were settled without a
/// record. The store has the committed ones too, written with their rows, so that the next process
/// begins with them. Of the others it gets those that stand before a committed one of their twin:
/// if they came again as new ones, they would come after it. And it gets which of its own are over,
/// since a message without a record has their packet id by now: a later one under that id, of the
/// same content, would be taken for them else.
///
/// Limits:  an entry per packet id, of which there are 65,535.
/// Thread:  confined to its owner's.
class Redeliveries final {
 public:
  /// `kept_max` as storage::DeliveriesKept.
  explicit Redeliveries(std::uint32_t kept_max) : kept_max_(kept_max), last_ordinal_(kept_max) {}

  /// Begins with what the store knows, under a new lease. What waits here is known better.
  void Begin(const storage::DeliveryMemory& memory) {
    expired_.clear();
    Load(memory, false);
  }
  /// The store is to be asked what it knows: it may lack what was committed until now. What rests
  /// on that without a record is known no more. No record of its twin came after it, which would
  /// have brought its number: so it can be judged again.
  void BeginReread();
  /// The same under the lease that we have, with what the store knew at some time after
  /// BeginReread: what was committed since is known still, and what the store was never told.
  void Reread(const storage::DeliveryMemory& memory) { Load(memory, true); }

  enum class Known : std::uint8_t { kNo, kWaits, kSettled };
  /// Whose message was settled without a record, and why. A value.
  struct SettledFor {
    /// Its twin's; 0 if it has none.
    std::uint64_t stream = 0;
    /// The shard of its twin, if it left no record because of what the store has of that twin.
    std::optional<std::size_t> rests_on{};
  };
  struct Found {
    Known known = Known::kNo;
    /// Of one that waits: the stream in which it does, and its number.
    std::uint64_t stream = 0;
    std::uint64_t number = 0;
    /// Of one that is settled: as SettledFor's.
    std::optional<std::size_t> rests_on{};
  };
  /// What is known of a message that the broker says it may have sent before.
  [[nodiscard]] Found Find(std::uint16_t packet_id, const storage::DeliveryDigest& digest) const;

  /// The next number, for a new message.
  [[nodiscard]] std::uint64_t NextNumber() { return ++last_number_; }
  /// A new message waits under the id: what the id meant before has ended.
  void AddWaiting(const storage::Delivery& delivery, std::uint64_t stream);
  /// A new message under the id is settled without a record.
  void AddSettled(std::uint16_t packet_id, const storage::DeliveryDigest& digest,
                  const SettledFor& settled);
  /// Leaves of packet ids those under which a message of the stream was settled so that may come
  /// again and is not in the store; each once, the oldest first.
  void KeepSettled(std::uint64_t stream, std::vector<std::uint16_t>& packet_ids) const;
  /// Gives these messages numbers, under which the store is to remember them with a commit that
  /// Commit or Drop tells of, for each.
  [[nodiscard]] std::vector<storage::Delivery> Number(std::uint64_t stream,
                                                      std::vector<std::uint16_t> packet_ids);
  /// A new message under the id is settled at once, and not remembered.
  void End(std::uint16_t packet_id);
  /// Deliveries that the store knows, or will know, and that expired since the last call.
  [[nodiscard]] std::vector<storage::Delivery> TakeExpired();
  /// It was committed.
  void Commit(std::uint16_t packet_id, std::uint64_t number);
  /// It was not, and never will be: it is new when it comes again.
  void Drop(std::uint16_t packet_id, std::uint64_t number);
  /// The same of what was settled without a record for that stream and got no number.
  void DropSettled(std::uint64_t stream, std::vector<std::uint16_t> packet_ids);

  /// The broker lost the session: nothing that is known comes again. Returns what is to be
  /// remembered of that.
  [[nodiscard]] storage::Delivery EndSession();

 private:
  struct Entry {
    /// 0: the store does not have it.
    std::uint64_t number = 0;
    /// Counts all messages at QoS 1, those that got no number too: packet ids come round by it.
    std::uint64_t ordinal = 0;
    /// Nothing: it is not known when it comes again.
    std::optional<storage::DeliveryDigest> digest;
    /// 0: it is settled.
    std::uint64_t stream = 0;
    /// Of one without a record; its stream is 0 once it has a number.
    SettledFor settled{};
    /// It was committed after the last BeginReread.
    bool is_fresh = false;
    /// It was settled without a record, and the store was not told: it has no number, or that goes
    /// with a commit which is under way.
    bool is_untold = false;
  };
  /// A message without a record has the packet id from now on.
  void Replace(std::uint16_t packet_id, const Entry& entry);
  /// The broker does not deliver it again: the ids went round since.
  [[nodiscard]] bool IsOld(const Entry& entry) const {
    return entry.ordinal + kept_max_ <= last_ordinal_;
  }
  void Load(const storage::DeliveryMemory& memory, bool keep_settled);

  const std::uint32_t kept_max_;
  std::uint64_t last_number_ = 0;
  /// Of what the store knows only the numbers are known, which are as far apart or less.
  std::uint64_t last_ordinal_;
  std::unordered_map<std::uint16_t, Entry> known_;
  /// Packet ids under which the store knows an expired delivery; each once until it gets a number.
  std::vector<std::uint16_t> expired_;
};

}  // namespace uplink::broker
