#include "server/broker/redeliveries.h"

#include <algorithm>

namespace uplink::broker {

void Redeliveries::Begin(const storage::DeliveryMemory& memory) {
  std::erase_if(known_, [](const auto& each) { return each.second.stream == 0; });
  for (const storage::Delivery& delivery : memory.known) {
    known_.try_emplace(delivery.packet_id,
                       Entry{.number = delivery.number, .digest = delivery.digest});
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
  if (entry.number + kept_max_ <= last_number_) return {};
  return {.known = Known::kCommitted, .number = entry.number};
}

void Redeliveries::AddWaiting(const storage::Delivery& delivery, std::uint64_t stream) {
  known_[delivery.packet_id] = {
      .number = delivery.number, .digest = delivery.digest, .stream = stream};
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
