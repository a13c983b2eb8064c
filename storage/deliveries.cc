#include "storage/deliveries.h"

#include <algorithm>
#include <map>

namespace uplink::storage {

DeliveryMemory MemoryOf(const std::vector<Delivery>& rows, std::uint64_t forget_below) {
  DeliveryMemory memory;
  memory.last_number = forget_below == 0 ? 0 : forget_below - 1;
  std::map<std::uint16_t, const Delivery*> latest;
  for (const Delivery& row : rows) {
    memory.last_number = std::max(memory.last_number, row.number);
    if (row.number >= forget_below) latest[row.packet_id] = &row;
  }
  for (const auto& [packet_id, row] : latest) {
    if (row->digest) memory.known.push_back(*row);
  }
  std::ranges::sort(memory.known, {}, &Delivery::number);
  return memory;
}

}  // namespace uplink::storage
