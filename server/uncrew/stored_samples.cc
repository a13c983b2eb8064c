#include "server/uncrew/stored_samples.h"

#include <utility>

#include "server/robot/mutation.h"

namespace uplink::uncrew {
namespace {

std::size_t BytesOf(const storage::SampleMemory& memory) {
  return memory.last.size() + memory.digests.size() * sizeof(storage::SampleDigest);
}

}  // namespace

void StoredSamples::Set(std::vector<storage::SampleMemory> memories) {
  by_number_ = {};
  bytes_ = 0;
  if (robot::Planted(robot::Mutation::kClaimMemoryForgotten)) return;
  for (storage::SampleMemory& memory : memories) {
    // A later version of the program may have stored more types.
    if (memory.type >= by_number_.size()) continue;
    bytes_ += BytesOf(memory);
    by_number_[memory.type] = std::move(memory);
  }
}

void StoredSamples::Add(const storage::SampleMark& mark) {
  storage::SampleMemory& memory = by_number_[mark.type];
  memory.type = mark.type;
  bytes_ -= BytesOf(memory);
  storage::Remember(mark, memory);
  bytes_ += BytesOf(memory);
}

}  // namespace uplink::uncrew
