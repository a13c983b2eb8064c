#include "storage/samples.h"

#include <algorithm>

namespace uplink::storage {

bool IsDuplicate(const SampleMark& mark, const SampleMemory& memory) {
  const std::vector<SampleDigest>& digests = memory.digests;
  if (digests.empty()) return false;
  if (!mark.timed) return digests.back() == mark.digest;
  return std::ranges::find(digests, mark.digest) != digests.end();
}

void Remember(const SampleMark& mark, SampleMemory& memory) {
  std::vector<SampleDigest>& digests = memory.digests;
  if (digests.size() == kSamplesKept) digests.erase(digests.begin());
  digests.push_back(mark.digest);
  memory.last = mark.last;
}

std::string PackedDigests(const std::vector<SampleDigest>& digests) {
  std::string packed;
#ifdef UPLINK_SAMPLES_FORGOTTEN
  if (!digests.empty()) return packed;
#endif
  packed.reserve(digests.size() * std::tuple_size_v<SampleDigest>);
  for (const SampleDigest& digest : digests) packed.append(digest.begin(), digest.end());
  return packed;
}

std::optional<std::vector<SampleDigest>> DigestsIn(std::string_view packed) {
  constexpr std::size_t kBytes = std::tuple_size_v<SampleDigest>;
  if (packed.size() % kBytes != 0 || packed.size() > kSamplesKept * kBytes) return std::nullopt;
  std::vector<SampleDigest> digests(packed.size() / kBytes);
  for (std::size_t i = 0; i < digests.size(); ++i) {
    std::ranges::transform(packed.substr(i * kBytes, kBytes), digests[i].begin(),
                           [](char byte) { return static_cast<std::uint8_t>(byte); });
  }
  return digests;
}

}  // namespace uplink::storage
