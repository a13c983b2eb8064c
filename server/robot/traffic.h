#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace uplink::robot {

/// What one robot has sent to this process, and how much of it went to the store. Thread-safe.
class Traffic final {
 public:
  /// Since the start. A value.
  struct Totals {
    std::uint64_t messages = 0;
    /// As they came: of a stream its frames, of a broker and of calls the payloads.
    std::uint64_t bytes = 0;
    /// Rows that were given to the journal.
    std::uint64_t rows = 0;
  };

  void CountMessages(std::size_t messages) { Add(messages_, messages); }
  void CountBytes(std::size_t bytes) { Add(bytes_, bytes); }
  void CountRows(std::size_t rows) { Add(rows_, rows); }

  [[nodiscard]] Totals totals() const {
    return {.messages = messages_.load(std::memory_order_relaxed),
            .bytes = bytes_.load(std::memory_order_relaxed),
            .rows = rows_.load(std::memory_order_relaxed)};
  }

 private:
  static void Add(std::atomic<std::uint64_t>& count, std::size_t more) {
    count.fetch_add(more, std::memory_order_relaxed);
  }

  std::atomic<std::uint64_t> messages_{0};
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::uint64_t> rows_{0};
};

}  // namespace uplink::robot
