#include "server/uncrew/stored_samples.h"

#include <utility>

#include "server/robot/mutation.h"

namespace uplink::uncrew {

void StoredSamples::Set(std::vector<storage::SampleMemory> memories) {
  by_number_ = {};
  if (robot::Planted(robot::Mutation::kClaimMemoryForgotten)) return;
  for (storage::SampleMemory& memory : memories) {
    // One of a later version of the program may have more types.
    if (memory.type >= by_number_.size()) continue;
    by_number_[memory.type] = std::move(memory);
  }
}

void StoredSamples::Add(const storage::SampleMark& mark) {
  storage::SampleMemory& memory = by_number_[mark.type];
  memory.type = mark.type;
  storage::Remember(mark, memory);
}

std::size_t StoredSamples::bytes() const {
  std::size_t bytes = 0;
  for (const storage::SampleMemory& memory : by_number_) {
    bytes += memory.last.size() + memory.digests.size() * sizeof(storage::SampleDigest);
  }
  return bytes;
}

}  // namespace uplink::uncrew
