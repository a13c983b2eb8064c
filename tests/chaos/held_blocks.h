#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <span>

namespace uplink::chaos {

/// Sizes of what a disk writes as a whole.
inline constexpr std::int64_t kBlockBytes = 512;

/// What was written to one file and not yet synced. It lies in this process alone, so a kill loses
/// it as a loss of power loses what a disk had in its cache; some blocks get through by chance, in
/// any order, as they do there.
///
/// Thread: thread-safe; the functions passed in are called under its lock.
class HeldBlocks final {
 public:
  using Bytes = std::span<char>;
  /// Reads a whole range of the file as it is on disk; what lies past its end is zero. 0 or an
  /// error code, here and below.
  using ReadFile = std::function<int(Bytes bytes, std::int64_t offset)>;
  using WriteFile = std::function<int(std::span<const char> bytes, std::int64_t offset)>;

  HeldBlocks(std::int64_t size, std::uint64_t seed) : size_(size), random_(seed) {}

  /// The size that the file would have.
  [[nodiscard]] std::int64_t size() const;
  /// Reads the range as if all writes had reached the file.
  [[nodiscard]] int Read(Bytes bytes, std::int64_t offset, const ReadFile& read) const;
  [[nodiscard]] int Write(std::span<const char> bytes, std::int64_t offset, const ReadFile& read,
                          const WriteFile& write);
  /// Writes all that is held to the file.
  [[nodiscard]] int Flush(const WriteFile& write);
  void Truncate(std::int64_t size);

 private:
  using Block = std::array<char, static_cast<std::size_t>(kBlockBytes)>;
  [[nodiscard]] int Put(std::int64_t offset, const Block& block, const WriteFile& write) const;

  mutable std::mutex mutex_;
  std::int64_t size_;
  std::mt19937_64 random_;
  std::map<std::int64_t, Block> blocks_;
};

}  // namespace uplink::chaos
