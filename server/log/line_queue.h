#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace uplink::log {

/// Finished lines between the threads that log and the one that writes, in order. A line that does
/// not fit is dropped and counted: if the reader stalls, lines are lost and no logging thread
/// waits.
///
/// Limits: kLinesMax and kBytesMax; lines that are being written count.
/// Thread: thread-safe; Take is for one thread.
class LineQueue final {
 public:
  struct Limits {
    std::size_t lines_max = kLinesMax;
    std::size_t bytes_max = kBytesMax;
  };
  /// Minutes of a busy server at level info, seconds at debug.
  static constexpr std::size_t kLinesMax = 8192;
  static constexpr std::size_t kBytesMax = 2UL * 1024 * 1024;

  /// Lines for the thread that writes. A value.
  struct Taken {
    std::vector<std::string> lines;
    /// Lines that were dropped after these, and before those that are taken next.
    std::uint64_t lost = 0;
  };

  explicit LineQueue(const Limits& limits) : limits_(limits) {}
  LineQueue(const LineQueue&) = delete;
  LineQueue& operator=(const LineQueue&) = delete;

  /// Appends a line, or drops it if there is no room, or after Close.
  void Push(std::string line);
  /// Waits until there is a line or a loss, and takes all of it. Nothing once the queue is closed
  /// and empty. Lines that were taken before now count as written.
  [[nodiscard]] std::optional<Taken> Take();
  /// A line that was taken could not be written.
  void NoteUnwritten();
  /// From now on drops every line.
  void Close();
  /// Waits until all lines pushed so far are written or given up, `wait` at most.
  void WaitUntilWritten(milliseconds wait);

  [[nodiscard]] LineCounts counts() const;

 private:
  [[nodiscard]] std::size_t Waiting() const { return lines_.size() + taken_lines_; }

  const Limits limits_;
  mutable std::mutex mutex_;
  std::condition_variable pushed_;
  std::condition_variable written_;
  std::vector<std::string> lines_;
  std::size_t bytes_ = 0;
  /// Of the lines that are being written.
  std::size_t taken_lines_ = 0;
  std::size_t taken_bytes_ = 0;
  /// Dropped since the last Take.
  std::uint64_t lost_ = 0;
  std::uint64_t dropped_total_ = 0;
  std::uint64_t pushed_total_ = 0;
  std::uint64_t written_total_ = 0;
  bool closed_ = false;
};

}  // namespace uplink::log
