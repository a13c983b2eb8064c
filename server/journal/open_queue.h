#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "server/robot/commit_client.h"
#include "storage/open_stream.h"

namespace uplink::journal {

/// A stream that was asked for and is not open yet.
struct OpenEntry {
  robot::ClientRef client;
  std::uint64_t open_id = 0;
  storage::OpenRequest request;
  /// As Moved's.
  std::string gateway = {};
};

/// The streams that wait for an OpenStream, in order: at most one per robot, the newest.
///
/// Limits: one entry per robot in memory (limits.robots_max, and fleet::kLeavingMax).
/// Thread: confined to its owner's lock; unopened() and CountOpened: any thread.
class OpenQueue final {
 public:
  /// False if it replaced one of the same robot that waited already.
  bool Push(OpenEntry entry);
  /// Moves the first ones to the end of `taken` until it holds `most`. One whose robot is in
  /// `taken` already replaces that.
  [[nodiscard]] std::vector<OpenEntry> MoveTo(std::vector<OpenEntry> taken, std::size_t most);
  /// What was taken waits again, ahead of the others and in its order. Where a newer one of the
  /// same robot waits, that stands for it.
  void PutBack(std::vector<OpenEntry> taken);
  /// So many of those that were taken are open.
  void CountOpened(std::size_t count) { unopened_.fetch_sub(count); }

  /// None waits to be taken.
  [[nodiscard]] bool empty() const { return queue_.empty(); }
  /// Those that wait, and those that were taken and are not open yet.
  [[nodiscard]] std::size_t unopened() const { return unopened_.load(); }

 private:
  std::deque<OpenEntry> queue_;
  std::atomic<std::size_t> unopened_{0};
};

}  // namespace uplink::journal
