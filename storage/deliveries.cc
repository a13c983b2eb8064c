#include "storage/deliveries.h"

#include <algorithm>
#include <map>
#include <utility>

namespace uplink::storage {

DeliveryMemory MemoryOf(const std::vector<Delivery>& rows) {
  DeliveryMemory memory;
  std::map<std::uint16_t, const Delivery*> latest;
  for (const Delivery& row : rows) {
    memory.last_number = row.number;
    if (row.packet_id == 0) {
      latest.clear();
    } else {
      latest[row.packet_id] = &row;
    }
  }
  for (const auto& [packet_id, row] : latest) {
    if (row->digest) memory.known.push_back(*row);
  }
  std::ranges::sort(memory.known, {}, &Delivery::number);
  return memory;
}

DeliveryMemory NumberedAnew(DeliveryMemory memory, std::uint32_t kept_max) {
  std::erase_if(memory.known, [&, last = memory.last_number](const Delivery& delivery) {
    return delivery.number + kept_max <= last;
  });
  for (Delivery& delivery : memory.known) delivery.number = ++memory.last_number;
  return memory;
}

}  // namespace uplink::storage
