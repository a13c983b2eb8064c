#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::bench {

/// What a sink says once it is subscribed.
inline constexpr const char* kSinkReady = "subscribed";

/// How many messages a sink has taken, in a file that it and the benchmark map: reading it costs
/// the sink nothing. Thread-safe, across processes too.
class SinkCount final {
 public:
  /// Makes the file if there is none. Aborts if that fails.
  explicit SinkCount(const std::string& path) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    UPLINK_CHECK(file >= 0 && ftruncate(file, sizeof(Count)) == 0, "a benchmark can make a file");
    void* memory = mmap(nullptr, sizeof(Count), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    UPLINK_CHECK(memory != MAP_FAILED, "a benchmark can map a file");
    close(file);
    // A new file is zero, which is a count of none.
    count_ = static_cast<Count*>(memory);
  }
  ~SinkCount() { munmap(count_, sizeof(Count)); }
  SinkCount(const SinkCount&) = delete;
  SinkCount& operator=(const SinkCount&) = delete;

  void Add() { count_->fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t Read() const { return count_->load(std::memory_order_relaxed); }

 private:
  using Count = std::atomic<std::uint64_t>;
  static_assert(Count::is_always_lock_free, "it lies in memory of two processes");

  Count* count_ = nullptr;
};

}  // namespace uplink::bench
