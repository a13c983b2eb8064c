#include "server/broker/redeliveries.h"

#include <algorithm>
#include <utility>

namespace uplink::broker {

void Redeliveries::Load(const storage::DeliveryMemory& memory, bool keep_settled) {
  const std::unordered_map<std::uint16_t, Entry> before = std::exchange(known_, {});
  for (const auto& [packet_id, entry] : before) {
    const bool only_here = keep_settled && (entry.number == 0 || entry.is_fresh || entry.is_untold);
    if (entry.stream != 0 || only_here) known_.emplace(packet_id, entry);
  }
  for (const storage::Delivery& delivery : memory.known) {
    Entry entry{.number = delivery.number, .digest = delivery.digest};
    const std::uint64_t ago = memory.last_number - delivery.number;
    if (ago > last_ordinal_) continue;
    entry.ordinal = last_ordinal_ - ago;
    const auto was = before.find(delivery.packet_id);
    if (was != before.end() && was->second.number == delivery.number) {
      entry.ordinal = was->second.ordinal;
    }
    known_.try_emplace(delivery.packet_id, entry);
  }
  last_number_ = std::max(last_number_, memory.last_number);
}

Redeliveries::Found Redeliveries::Find(std::uint16_t packet_id,
                                       const storage::DeliveryDigest& digest) const {
  const auto found = known_.find(packet_id);
  if (found == known_.end() || found->second.digest != digest) return {};
  const Entry& entry = found->second;
  if (entry.stream != 0) {
    return {.known = Known::kWaits, .stream = entry.stream, .number = entry.number};
  }
  if (IsOld(entry)) return {};
  return {.known = Known::kSettled, .number = entry.number, .rests_on = entry.settled.rests_on};
}

void Redeliveries::AddWaiting(const storage::Delivery& delivery, std::uint64_t stream) {
  known_[delivery.packet_id] = {.number = delivery.number,
                                .ordinal = ++last_ordinal_,
                                .digest = delivery.digest,
                                .stream = stream};
}

void Redeliveries::Replace(std::uint16_t packet_id, const Entry& entry) {
  Entry& kept = known_[packet_id];
  if (kept.number != 0) expired_.push_back(packet_id);
  kept = entry;
  kept.ordinal = ++last_ordinal_;
}

void Redeliveries::AddSettled(std::uint16_t packet_id, const storage::DeliveryDigest& digest,
                              const SettledFor& settled) {
  Replace(packet_id, {.digest = digest, .settled = settled, .is_untold = true});
}

void Redeliveries::Expire(std::uint16_t packet_id) { Replace(packet_id, {}); }

void Redeliveries::KeepSettled(std::uint64_t stream, std::vector<std::uint16_t>& packet_ids) const {
  std::erase_if(packet_ids, [&](std::uint16_t packet_id) {
    const auto found = known_.find(packet_id);
    return found == known_.end() || found->second.number != 0 ||
           found->second.settled.stream != stream || IsOld(found->second);
  });
  std::ranges::sort(packet_ids, {}, [this](std::uint16_t packet_id) {
    return known_.find(packet_id)->second.ordinal;
  });
  packet_ids.erase(std::unique(packet_ids.begin(), packet_ids.end()), packet_ids.end());
}

std::vector<storage::Delivery> Redeliveries::Number(std::uint64_t stream,
                                                    std::vector<std::uint16_t> packet_ids) {
  KeepSettled(stream, packet_ids);
  std::vector<storage::Delivery> numbered;
  numbered.reserve(packet_ids.size() + 1);
  for (const std::uint16_t packet_id : packet_ids) {
    Entry& entry = known_.find(packet_id)->second;
    entry.number = NextNumber();
    entry.settled.stream = 0;
    numbered.push_back({.number = entry.number, .packet_id = packet_id, .digest = entry.digest});
  }
  return numbered;
}

std::vector<storage::Delivery> Redeliveries::TakeExpired() {
  std::vector<storage::Delivery> ends;
  for (const std::uint16_t packet_id : std::exchange(expired_, {})) {
    const auto found = known_.find(packet_id);
    // The message that has the id now was remembered itself.
    if (found != known_.end() && found->second.number != 0) continue;
    ends.push_back({.number = NextNumber(), .packet_id = packet_id, .digest = {}});
  }
  return ends;
}

void Redeliveries::Commit(std::uint16_t packet_id, std::uint64_t number) {
  const auto found = known_.find(packet_id);
  if (found == known_.end() || found->second.number != number) return;
  found->second.stream = 0;
  found->second.is_fresh = true;
  found->second.is_untold = false;
}

void Redeliveries::BeginReread() {
  for (auto& [packet_id, entry] : known_) {
    entry.is_fresh = false;
    // The store may still remember an older one under its id: that has expired all the same.
    if (entry.settled.rests_on && entry.number == 0) entry = {.ordinal = entry.ordinal};
  }
}

void Redeliveries::Drop(std::uint16_t packet_id, std::uint64_t number) {
  const auto found = known_.find(packet_id);
  if (found != known_.end() && found->second.number == number) known_.erase(found);
}

void Redeliveries::DropSettled(std::uint64_t stream, std::vector<std::uint16_t> packet_ids) {
  KeepSettled(stream, packet_ids);
  for (const std::uint16_t packet_id : packet_ids) known_.erase(packet_id);
}

storage::Delivery Redeliveries::EndSession() {
  known_.clear();
  expired_.clear();
  return {.number = NextNumber(), .packet_id = 0, .digest = {}};
}

}  // namespace uplink::broker
