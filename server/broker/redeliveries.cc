#include "server/broker/redeliveries.h"

#include <algorithm>
#include <utility>

namespace uplink::broker {

void Redeliveries::Load(const storage::DeliveryMemory& memory, bool keep_settled) {
  const std::unordered_map<std::uint16_t, Entry> before = std::exchange(known_, {});
  for (const auto& [packet_id, entry] : before) {
    const bool only_here = keep_settled && entry.number == 0;
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
  if (entry.ordinal + kept_max_ <= last_ordinal_) return {};
  return {.known = Known::kSettled, .number = entry.number};
}

void Redeliveries::AddWaiting(const storage::Delivery& delivery, std::uint64_t stream) {
  known_[delivery.packet_id] = {.number = delivery.number,
                                .ordinal = ++last_ordinal_,
                                .digest = delivery.digest,
                                .stream = stream};
}

void Redeliveries::AddSettled(std::uint16_t packet_id, const storage::DeliveryDigest& digest) {
  known_[packet_id] = {.number = 0, .ordinal = ++last_ordinal_, .digest = digest, .stream = 0};
}

std::vector<storage::Delivery> Redeliveries::Number(std::vector<storage::Delivery> settled) {
  std::erase_if(settled, [this](storage::Delivery& delivery) {
    const auto found = known_.find(delivery.packet_id);
    // Another message has the id by now, or the session was lost.
    if (found == known_.end() || found->second.digest != delivery.digest ||
        found->second.number != 0) {
      return true;
    }
    found->second.number = delivery.number = NextNumber();
    return false;
  });
  return settled;
}

void Redeliveries::End(std::uint16_t packet_id) {
  ++last_ordinal_;
  known_.erase(packet_id);
}

void Redeliveries::Commit(std::uint16_t packet_id, std::uint64_t number) {
  const auto found = known_.find(packet_id);
  if (found != known_.end() && found->second.number == number) found->second.stream = 0;
}

void Redeliveries::Drop(std::uint16_t packet_id, std::uint64_t number) {
  const auto found = known_.find(packet_id);
  if (found != known_.end() && found->second.number == number) known_.erase(found);
}

storage::Delivery Redeliveries::EndSession() {
  known_.clear();
  return {.number = NextNumber(), .packet_id = 0, .digest = {}};
}

}  // namespace uplink::broker
