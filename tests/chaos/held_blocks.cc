#include "tests/chaos/held_blocks.h"

#include <algorithm>

namespace uplink::chaos {
namespace {

/// One block in so many gets through before the sync.
constexpr std::uint64_t kThroughOneIn = 4;

/// Calls `part(block's offset, offset in it, offset in the range, bytes)` for each block that the
/// range touches.
template <typename Part>
void ForEachBlock(std::int64_t offset, std::size_t bytes, const Part& part) {
  std::size_t done = 0;
  while (done < bytes) {
    const std::int64_t at = offset + static_cast<std::int64_t>(done);
    const std::int64_t in_block = at % kBlockBytes;
    const std::size_t some =
        std::min(bytes - done, static_cast<std::size_t>(kBlockBytes - in_block));
    part(at - in_block, static_cast<std::size_t>(in_block), done, some);
    done += some;
  }
}

}  // namespace

std::int64_t HeldBlocks::size() const {
  const std::lock_guard lock(mutex_);
  return size_;
}

int HeldBlocks::Read(Bytes bytes, std::int64_t offset, const ReadFile& read) const {
  // From the file under the lock, too: a sync moves blocks from here to there.
  const std::lock_guard lock(mutex_);
  const int code = read(bytes, offset);
  if (code != 0) return code;
  ForEachBlock(offset, bytes.size(),
               [&](std::int64_t block, std::size_t from, std::size_t to, std::size_t some) {
                 const auto held = blocks_.find(block);
                 if (held == blocks_.end()) return;
                 std::copy_n(held->second.begin() + static_cast<std::ptrdiff_t>(from), some,
                             bytes.begin() + static_cast<std::ptrdiff_t>(to));
               });
  return 0;
}

int HeldBlocks::Write(std::span<const char> bytes, std::int64_t offset, const ReadFile& read,
                      const WriteFile& write) {
  const std::lock_guard lock(mutex_);
  size_ = std::max(size_, offset + static_cast<std::int64_t>(bytes.size()));
  int code = 0;
  ForEachBlock(offset, bytes.size(),
               [&](std::int64_t block, std::size_t to, std::size_t from, std::size_t some) {
                 if (code != 0) return;
                 const auto [held, first] = blocks_.try_emplace(block);
                 if (first) code = read(held->second, block);
                 std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(from), some,
                             held->second.begin() + static_cast<std::ptrdiff_t>(to));
                 if (code != 0 || random_() % kThroughOneIn != 0) return;
                 code = Put(block, held->second, write);
                 blocks_.erase(held);
               });
  return code;
}

int HeldBlocks::Flush(const WriteFile& write) {
  const std::lock_guard lock(mutex_);
  for (const auto& [offset, block] : blocks_) {
    const int code = Put(offset, block, write);
    if (code != 0) return code;
  }
  blocks_.clear();
  return 0;
}

void HeldBlocks::Truncate(std::int64_t size) {
  const std::lock_guard lock(mutex_);
  size_ = size;
  blocks_.erase(blocks_.lower_bound(size), blocks_.end());
}

int HeldBlocks::Put(std::int64_t offset, const Block& block, const WriteFile& write) const {
  const auto bytes = static_cast<std::size_t>(std::min(kBlockBytes, size_ - offset));
  return write(std::span(block).first(bytes), offset);
}

}  // namespace uplink::chaos
